#include "fem/element.h"

namespace flexmorph::fem {

const ShapeElement& Element::with_shapes() const {
  if (const ShapeElement* out = shape_element()) return *out;
  throw Error::input(
      "a body without shape functions has no material coordinates: points of a rigid body are "
      "given by locations of markers");
}

std::vector<NodeVectors> Element::edge(const std::string& name) const {
  if (!shape_element())
    throw Error::input("edge '" + name +
                       "': a body without shape functions, such as a rigid one, has no edges");
  return shape_element()->edge(name);
}

void Element::tabulate_eulerian(int e, int degree, Tabulate what, EulerianTable& out) const {
  if (!eulerian_lines())
    throw Error::input("element " + std::to_string(e + 1) +
                       ": a body with this kind of elements has no free material lines");
  eulerian_lines()->tabulate_eulerian(e, degree, what, out);
}

}  // namespace flexmorph::fem
