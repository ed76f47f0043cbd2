#include "cases/assembly/joints.h"

#include "cases/assembly/build.h"
#include "cases/scene/joints/row.h"

namespace flexmorph::cases {
namespace {

/// Returns the angle of the first axis of an anchor at the start, from the angles of the case
/// [rad].
double start_angle(const Scene& scene, const Anchor& anchor) {
  for (const RigidBody& b : scene.rigid_bodies)
    if (b.name == anchor.body) return b.angle + anchor.angle;
  return anchor.angle;
}

}  // namespace

Vec2 start_location(const Scene& scene, const Anchor& anchor) {
  if (anchor.on_ground()) return anchor.point;
  for (const RigidBody& b : scene.rigid_bodies)
    if (b.name == anchor.body) return b.position + fem::rotation(b.angle) * anchor.point;
  return start_pose(scene, scene.body(anchor.body)).location(anchor.point).head<2>();
}

Anchor completed(const Scene& scene, const Anchor& anchor, const Anchor& other) {
  Anchor out = anchor;
  if (!anchor.given) out.point = start_location(scene, other);
  out.given = true;
  return out;
}

std::unique_ptr<fem::Joint> make_joint(const Scene& scene, const Joint& joint,
                                       const FindLocation& location, bool rigid) {
  if (!joint.row->make) return nullptr;
  JointParts parts{.scene = scene, .rigid = rigid};
  if (joint.between_bodies()) {
    parts.a = location(completed(scene, joint.a, joint.b));
    parts.b = location(completed(scene, joint.b, joint.a));
    parts.angle_a = start_angle(scene, joint.a);
    parts.angle_b = start_angle(scene, joint.b);
  } else {
    parts.location = [&](const Vec2& material) { return location({joint.body, material}); };
    parts.start = [&](const Vec2& material) {
      return start_pose(scene, scene.body(joint.body)).location(material);
    };
  }
  return joint.row->make(joint, parts);
}

std::unique_ptr<fem::ForceElement> make_force_element(const Scene& scene, const Spring& spring,
                                                      const FindLocation& location) {
  return spring.row->make(spring, location(completed(scene, spring.a, spring.b)),
                          location(completed(scene, spring.b, spring.a)),
                          start_angle(scene, spring.b) - start_angle(scene, spring.a));
}

}  // namespace flexmorph::cases
