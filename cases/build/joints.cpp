#include "cases/build/joints.h"

#include "cases/build/build.h"

namespace flexmorph::cases {

Vec2 start_place(const Scene& scene, const Anchor& anchor) {
  if (anchor.on_ground()) return anchor.point;
  for (const RigidBody& b : scene.rigid_bodies)
    if (b.name == anchor.body) return b.position + fem::rotation(b.angle) * anchor.point;
  return start_pose(scene, scene.body(anchor.body)).place(anchor.point).head<2>();
}

Anchor completed(const Scene& scene, const Anchor& anchor, const Anchor& other) {
  Anchor out = anchor;
  if (!anchor.given) out.point = start_place(scene, other);
  out.given = true;
  return out;
}

std::unique_ptr<fem::Joint> make_body_joint(const Scene& scene, const Joint& joint,
                                            const FindPlace& place) {
  const fem::MarkerPlace a = place(completed(scene, joint.a, joint.b)),
                         b = place(completed(scene, joint.b, joint.a));
  const auto law = [&](size_t i) { return scene.motion_of(joint.laws[i]); };
  if (joint.type == "revolute") return fem::make_revolute(joint.name, a, b);
  if (joint.type == "weld") return fem::make_rigid_weld(joint.name, a, b);
  if (joint.type == "slider") return fem::make_slider(joint.name, a, b);
  if (joint.type == "angle_drive") return fem::make_angle_drive(joint.name, a, b, law(0));
  if (joint.type == "distance") return fem::make_distance(joint.name, a, b, law(0));
  std::vector<std::function<fem::Motion(double)>> laws;
  for (size_t i = 0; i < joint.laws.size(); ++i) laws.push_back(law(i));
  const fem::PointDrive path = [laws](double t) {
    std::vector<fem::Motion> out;
    for (const auto& each : laws) out.push_back(each(t));
    return out;
  };
  return fem::make_point_drive(joint.name, a, path, joint.components);
}

std::unique_ptr<fem::Link> make_link(const Spring& spring, const FindPlace& place) {
  const fem::MarkerPlace a = place(spring.a), b = place(spring.b);
  if (spring.torsion)
    return fem::make_torsion_spring(spring.name, a, b,
                                    {spring.stiffness, spring.damping, spring.rest});
  return fem::make_spring(spring.name, a, b, {spring.stiffness, spring.damping, spring.rest});
}

}  // namespace flexmorph::cases
