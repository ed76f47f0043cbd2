#include "cases/scene/body_keys.h"
#include "cases/scene/elements/row.h"
#include "cases/scene/read.h"
#include "fem/elements/ancf_beam.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

using namespace body_keys;
using io::Key;
using io::positive;
using io::Table;

const Key& kSpace = io::key("body", "space")
                        .word("a space", {"plane"})
                        .otherwise("plane")
                        .when("beams")
                        .description("Space of the beam; beams are in the plane.");
const Key& kHeight = io::key("body", "height")
                         .number(positive("a height, in the plane of the motion,", "m"))
                         .when("beams")
                         .description("Height of the cross-section, in the plane of the motion.");
const Key& kWidth =
    io::key("body", "width")
        .number(positive("a width, normal to the plane of the motion,", "m"))
        .when("beams")
        .description("Width of the cross-section, normal to the plane of the motion.");
const Key& kElements = io::key("body", "elements")
                           .integer("a number of elements", 1, 100'000)
                           .when("beams")
                           .description("Number of elements along the length.");
const Key& kArc =
    io::key("body", "arc")
        .number(io::between("the angle of an arc", "rad", -6.2, 6.2))
        .otherwise(0.0)
        .when("beams")
        .description(
            "Angle of the circular arc that the unstressed axis forms; 0 is a straight beam.");

/// Mode of a welded end of a beam: the section keeps its direction and is free to grow (partial),
/// or it keeps direction and size (edge), or the axis is not stretched, either (full).
const io::Choice<fem::WeldMode> kBeamMode(
    io::key("joint", "mode")
        .otherwise("partial")
        .when("`type = \"weld\"`, of a beam to a hub or a rigid body")
        .description(
            "The welded section may change its height, keeps it, or also has an unstretched axis."),
    "a mode of the weld of a beam",
    {{"partial", fem::WeldMode::partial},
     {"edge", fem::WeldMode::edge},
     {"full", fem::WeldMode::full}});
void read_beam(const Table& t, const Scene& scene, bool has_density, Body& body) {
  body.space = t.choice(kSpace);
  if (scene.in_space())
    t.fail(kElement, "beams are in the plane, but the bodies before are in space");
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
    t.fail(kArc, "half of the height of the beam must be less than the radius of its arc, " +
                     io::to_text(body.length / std::abs(body.arc), 4) + " m");
  refuse_flow(t);
  if (t.has(kLine)) t.fail("a beam has no [[body.line]], because its mesh lines do not move");
}

fem::WeldMode read_weld(const Table& joint) { return joint.choice(kBeamMode); }

std::unique_ptr<fem::Element> make_beam(const Body& body, double /*end*/,
                                        const std::array<int, 2>& count) {
  if (body.arc == 0) return std::make_unique<fem::AncfBeam>(body.length, body.width, count[0]);
  return std::make_unique<fem::AncfBeam>(fem::uniform_nodes(body.length, count[0]), body.width,
                                         fem::arc_reference(body.length, body.arc, count[0]));
}

/// Estimates the operations from the number of Gauss points.
ElementOperations operations(const Body&, const fem::Element& element) {
  const double points = 15, unknowns = element.n_shapes() * element.dim();
  return {points * 300, points * 4 * unknowns * unknowns};
}

}  // namespace

extern const ElementRow kAncfBeam;
const ElementRow kAncfBeam = {.name = "ancf_beam",
                              .sentence = "A beam in the plane.",
                              .read = read_beam,
                              .read_weld = read_weld,
                              .make = make_beam,
                              .operations = operations,
                              .in_plane = fem::TermDomain::beam,
                              .term = "a term of a beam",
                              .thinnest = "height",
                              .across = false,
                              .lines = false,
                              .spreads = false,
                              .designable = false,
                              .thermal_force = true,
                              .drawn = {8, 4},
                              .draws_strain = true};

}  // namespace flexmorph::cases
