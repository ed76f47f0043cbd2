#include "cases/scene/body_keys.h"
#include "cases/scene/read.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

using io::Key;
using io::positive;
using io::Table;

const Key& kSpace = io::key("body", "space")
                        .word("a space", {"plane"})
                        .otherwise("plane")
                        .when("beams")
                        .says("Beams live in the plane.");
const Key& kHeight = io::key("body", "height")
                         .number(positive("a height, in the plane of the motion,", "m"))
                         .when("beams")
                         .says("Of its section, in the plane of the motion.");
const Key& kWidth = io::key("body", "width")
                        .number(positive("a width, across the plane of the motion,", "m"))
                        .when("beams")
                        .says("Of its section, across the plane of the motion.");
const Key& kElements = io::key("body", "elements")
                           .integer("a number of elements", 1, 100'000)
                           .when("beams")
                           .says("Elements along the length.");
const Key& kArc = io::key("body", "arc")
                      .number(io::between("the angle of an arc", "rad", -6.2, 6.2))
                      .otherwise(0.0)
                      .when("beams")
                      .says("Angle that its axis turns by without stress; 0: it is straight.");

}  // namespace

void read_beam(const Table& t, const Scene& scene, bool has_density, Body& body) {
  using namespace body_keys;
  body.space = t.choice(kSpace);
  if (scene.in_space()) t.fail(kElement, "beams live in the plane, the bodies before in space");
  read_terms(t, scene, body);
  body.length = t.number(kLength);
  body.width = t.number(kHeight);
  body.thickness = t.number(kWidth);
  if (t.has(kThickness))
    t.fail(kThickness, "a beam has a `height` in the plane of the motion and a `width` across it");
  read_material(t, has_density, body);
  body.elements = {t.integer(kElements), 1};
  body.arc = t.number(kArc);
  if (body.arc != 0 && 0.5 * body.width >= body.length / std::abs(body.arc))
    t.fail(kArc, "half the height stays below the radius of the arc, " +
                     io::to_text(body.length / std::abs(body.arc), 4) + " m");
  if (t.has(kFlow)) t.fail(kFlow, "material flows through \"ale_ancf_plate\" only");
  if (t.has(kLine)) t.fail("the lines of a beam's elements stay where they are: no [[body.line]]");
}

}  // namespace flexmorph::cases
