#include "cases/scene/joints/reading.h"
#include "cases/scene/joints/row.h"

namespace flexmorph::cases {
namespace {

const io::Key& coordinate(const char* name) {
  return io::key("joint", name)
      .number(io::any_number("a coordinate", "m"))
      .name_of("a drive")
      .otherwise_as("the coordinate is free")
      .when("`type = \"point_drive\"`")
      .description(std::string("Coordinate ") + name +
                   " of `point_a` in the world; a number keeps it constant.");
}

const io::Key &kX = coordinate("x"), &kY = coordinate("y");

void read(const io::Table& t, const Scene& scene, Joint& joint) {
  joint.a = read_anchor(t, kAnchorA, scene, true, false);
  if (joint.a.on_ground())
    t.fail(kAnchorA.body, "`a` is a body, because the ground cannot be driven");
  for (const auto& [key, component] : {std::pair{&kX, 0}, std::pair{&kY, 1}})
    if (t.has(*key)) {
      joint.laws.push_back(read_law(t, *key, scene));
      joint.components.push_back(component);
    }
  if (joint.laws.empty()) t.fail("a driven point needs `x`, `y` or both");
  name_between(t, scene, joint);
}

std::unique_ptr<fem::Joint> make(const Joint& joint, const JointParts& parts) {
  std::vector<std::function<fem::Motion(double)>> laws;
  for (size_t i = 0; i < joint.laws.size(); ++i) laws.push_back(parts.law(joint, i));
  const fem::PointDrive path = [laws](double t) {
    std::vector<fem::Motion> out;
    for (const auto& each : laws) out.push_back(each(t));
    return out;
  };
  return fem::make_point_drive(joint.name, parts.a, path, joint.components);
}

}  // namespace

extern const JointRow kPointDrive;
const JointRow kPointDrive = {.name = "point_drive",
                              .sentence = "Prescribes coordinates of a point of a body.",
                              .read = read,
                              .make = make,
                              .on_one_body = true};

}  // namespace flexmorph::cases
