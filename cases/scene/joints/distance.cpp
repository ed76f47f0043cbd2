#include "cases/scene/joints/reading.h"
#include "cases/scene/joints/row.h"

namespace flexmorph::cases {
namespace {

const io::Key& kDistanceKey =
    io::key("joint", "distance")
        .number(io::positive("a distance", "m"))
        .name_of("a drive")
        .when("`type = \"distance\"`")
        .description("Distance between the points; a constant number models a massless rod.");

void read(const io::Table& t, const Scene& scene, Joint& joint) {
  const auto [a, b] = read_anchors(t, scene, true, false);
  joint.a = a, joint.b = b;
  joint.laws = {read_law(t, kDistanceKey, scene)};
  name_between(t, scene, joint);
}

std::unique_ptr<fem::Joint> make(const Joint& joint, const JointParts& parts) {
  return fem::make_distance(joint.name, parts.a, parts.b, parts.law(joint, 0));
}

}  // namespace

extern const JointRow kDistance;
const JointRow kDistance = {
    .name = "distance",
    .sentence =
        "Prescribes the distance between two points: a massless rod, or an actuator with a drive.",
    .read = read,
    .make = make,
    .coordinate = fem::distance_between};

}  // namespace flexmorph::cases
