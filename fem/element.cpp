#include "fem/element.h"

namespace flexmorph::fem {

const ShapeElement& Element::with_shapes() const {
  if (const ShapeElement* out = shape_element()) return *out;
  throw Error::input(
      "a body without shape functions has no material coordinates: points of a rigid body are "
      "places of markers");
}

std::vector<NodeVectors> Element::edge(const std::string& name) const {
  if (!shape_element())
    throw Error::input("edge '" + name +
                       "': a body without shape functions, such as a rigid one, has no edges");
  return shape_element()->edge(name);
}

void Element::tabulate_free(int e, int degree, Tabulate what, FreeTable& out) const {
  if (!free_lines()) throw Error::input("an element that knows no free material lines");
  free_lines()->tabulate_free(e, degree, what, out);
}

}  // namespace flexmorph::fem
