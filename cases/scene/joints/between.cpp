#include "cases/scene/joints/reading.h"
#include "cases/scene/joints/row.h"

/// Joints between anchors on two bodies that prescribe no motion, see fem/body_joints.h.
namespace flexmorph::cases {
namespace {

void read_revolute(const io::Table& t, const Scene& scene, Joint& joint) {
  const auto [a, b] = read_anchors(t, scene, true, false);
  joint.a = a, joint.b = b;
  name_between(t, scene, joint);
}

void read_slider(const io::Table& t, const Scene& scene, Joint& joint) {
  const auto [a, b] = read_anchors(t, scene, true, true);
  joint.a = a, joint.b = b;
  name_between(t, scene, joint);
}

}  // namespace

extern const JointRow kRevolute, kSlider;

const JointRow kRevolute = {.name = "revolute",
                            .sentence = "A revolute joint: two points coincide.",
                            .read = read_revolute,
                            .make = [](const Joint& j, const JointParts& parts) {
                              return fem::make_revolute(j.name, parts.a, parts.b);
                            }};

const JointRow kSlider = {
    .name = "slider",
    .sentence =
        "A prismatic joint: point b moves along the first axis of a, and both axes stay parallel.",
    .read = read_slider,
    .make = [](const Joint& j,
               const JointParts& parts) { return fem::make_slider(j.name, parts.a, parts.b); },
    .has_moment = true};

}  // namespace flexmorph::cases
