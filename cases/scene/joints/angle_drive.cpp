#include "cases/scene/joints/reading.h"
#include "cases/scene/joints/row.h"

namespace flexmorph::cases {
namespace {

const io::Key& kAngle = io::key("joint", "angle")
                            .number(io::any_number("an angle", "rad"))
                            .name_of("a drive")
                            .when("`type = \"angle_drive\"`")
                            .description(
                                "Angle from the first axis of `a` to the first axis of `b`; a "
                                "number keeps it constant.");

void read(const io::Table& t, const Scene& scene, Joint& joint) {
  const auto [a, b] = read_anchors(t, scene, false, true);
  joint.a = a, joint.b = b;
  joint.laws = {read_law(t, kAngle, scene)};
  name_between(t, scene, joint);
}

std::unique_ptr<fem::Joint> make(const Joint& joint, const JointParts& parts) {
  return fem::make_angle_drive(joint.name, parts.a, parts.b, parts.law(joint, 0));
}

}  // namespace

extern const JointRow kAngleDrive;
const JointRow kAngleDrive = {
    .name = "angle_drive",
    .sentence = "Prescribes the angle from the first axis of a to the first axis of b.",
    .read = read,
    .make = make,
    .coordinate = fem::angle_between,
    .drives_angle = true,
    .has_force = false,
    .has_moment = true};

}  // namespace flexmorph::cases
