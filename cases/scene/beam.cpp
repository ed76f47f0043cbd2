#include "cases/scene/read.h"
#include "io/files.h"

namespace flexmorph::cases {

using io::any_number;
using io::between;
using io::positive;
using io::Table;

void read_beam(const Table& t, const Scene& scene, bool has_density, Body& body) {
  constexpr int kMostElements = 100'000;
  body.space = t.choice("space", "a space", std::vector<std::string>{"plane"}, "plane");
  if (scene.in_space()) t.fail("element", "beams live in the plane, the bodies before in space");
  read_terms(t, scene, body);
  body.length = t.number("length", positive("a length", "m"));
  body.width = t.number("height", positive("a height, in the plane of the motion,", "m"));
  body.thickness = t.number("width", positive("a width, across the plane of the motion,", "m"));
  if (t.has("thickness"))
    t.fail("thickness", "a beam has a `height` in the plane of the motion and a `width` across it");
  body.density = t.number("density", positive("a density", "kg/m^3"),
                          has_density ? std::nullopt : std::optional<double>(1));
  body.youngs_modulus = t.number("youngs_modulus", positive("Young's modulus", "Pa"));
  body.poisson_ratio = t.number("poisson_ratio", between("Poisson's ratio", "", 0, 0.5));
  body.elements = {t.integer("elements", "a number of elements", 1, kMostElements), 1};
  auto turn = between("the angle of an arc", "rad", -6.2, 6.2);
  body.arc = t.number("arc", turn, 0.0);
  if (body.arc != 0 && 0.5 * body.width >= body.length / std::abs(body.arc))
    t.fail("arc", "half the height stays below the radius of the arc, " +
                      io::to_text(body.length / std::abs(body.arc), 4) + " m");
  if (t.has("flow")) t.fail("flow", "material flows through \"ale_ancf_plate\" only");
  if (t.has("line")) t.fail("the lines of a beam's elements stay where they are: no [[body.line]]");
}

}  // namespace flexmorph::cases
