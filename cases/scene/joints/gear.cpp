#include "cases/scene/joints/reading.h"
#include "cases/scene/joints/row.h"

namespace flexmorph::cases {
namespace {

const io::Key& kTeeth = io::key("joint", "teeth")
                            .integers("a number of teeth", 1, 10'000, 2, 2)
                            .when("`type = \"gear\"`")
                            .description("Numbers of teeth of the wheels `a` and `b`.");
const io::Key& kInner =
    io::key("joint", "inner")
        .boolean()
        .otherwise(false)
        .when("`type = \"gear\"`")
        .description(
            "True if one wheel has internal teeth; both wheels then turn in one direction.");

void read(const io::Table& t, const Scene& scene, Joint& joint) {
  const auto [a, b] = read_anchors(t, scene, false, true);
  joint.a = a, joint.b = b;
  if (joint.a.on_ground() || joint.b.on_ground())
    t.fail("a gear connects two rigid bodies, `a` and `b`; other joints define their axles");
  const std::vector<int> teeth = t.integers(kTeeth);
  joint.own = fem::GearData{teeth[0], teeth[1], t.boolean(kInner)};
  name_between(t, scene, joint);
}

std::unique_ptr<fem::Joint> make(const Joint& joint, const JointParts& parts) {
  auto wheels = std::any_cast<fem::GearData>(joint.own);
  wheels.angle_a = parts.angle_a;
  wheels.angle_b = parts.angle_b;
  return fem::make_gear(joint.name, parts.a, parts.b, wheels);
}

}  // namespace

extern const JointRow kGear;
const JointRow kGear = {
    .name = "gear",
    .sentence =
        "Couples the rotations of two rigid bodies like gear wheels with given numbers of teeth.",
    .read = read,
    .make = make,
    .has_force = false,
    .has_moment = true};

}  // namespace flexmorph::cases
