#include "cases/scene/joints/reading.h"
#include "cases/scene/joints/row.h"

namespace flexmorph::cases {
namespace {

const io::Key& kTeeth = io::key("joint", "teeth")
                            .integers("a number of teeth", 1, 10'000, 2, 2)
                            .when("gear")
                            .says("Of the wheels of `a` and of `b`.");
const io::Key& kInner = io::key("joint", "inner")
                            .boolean()
                            .otherwise(false)
                            .when("gear")
                            .says("One wheel has its teeth inside: both turn the same way.");

void read(const io::Table& t, const Scene& scene, Joint& joint) {
  const auto [a, b] = read_anchors(t, scene, false, true);
  joint.a = a, joint.b = b;
  if (joint.a.on_ground() || joint.b.on_ground())
    t.fail("a gear has two rigid bodies, `a` and `b`; their axles are joints of their own");
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
const JointRow kGear = {.name = "gear",
                        .sentence =
                            "Two rigid bodies turn as wheels that roll on each other: "
                            "their rates are as the numbers of teeth.",
                        .read = read,
                        .make = make,
                        .has_force = false,
                        .has_moment = true};

}  // namespace flexmorph::cases
