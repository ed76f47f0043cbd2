#include <algorithm>
#include <cmath>
#include <optional>

#include "cases/assembly/build.h"
#include "cases/assembly/joints.h"
#include "fem/rigid.h"

namespace flexmorph::cases {
namespace {

/// A point of a strip whose axis is an arc that begins along the first axis.
Vec2 on_arc(double curvature, const Vec2& material) {
  const double turn = curvature * material.x(), half = 0.5 * turn;
  const double chord = material.x() * (turn == 0 ? 1 : std::sin(half) / half);
  return chord * Vec2(std::cos(half), std::sin(half)) +
         material.y() * Vec2(-std::sin(turn), std::cos(turn));
}

}  // namespace

Vec3 Pose::place(const Vec2& material) const {
  const Vec2 flat(material.x() - line, material.y());
  const Vec2 r = origin + fem::rotation(angle) * (curvature == 0 ? flat : on_arc(curvature, flat));
  return {r.x(), r.y(), 0};
}

Vec2 undeformed_place(const Body& body, const Vec2& material) {
  return body.arc == 0 ? material : on_arc(body.arc / body.length, material);
}

namespace {

double curvature_of(const Body& body) { return body.arc == 0 ? 0 : body.arc / body.length; }

/// Where a hub, a rigid body or the case itself puts a body.
std::optional<Pose> own_pose(const Scene& scene, const Body& body) {
  for (const Joint& joint : scene.joints) {
    if (joint.body != body.name || !joint.holds_frame() || joint.edge == "free_end") continue;
    const double root = body.longest(scene.time.end) - body.length;
    const double line = body.start_lines(root, body.elements[0])[static_cast<size_t>(joint.line)];
    const double curvature = curvature_of(body);
    if (joint.to.empty()) return Pose{joint.position, joint.angle, line, curvature};
    if (joint.on_rigid_body())
      for (const RigidBody& b : scene.rigid_bodies)
        if (b.name == joint.b.body)
          return Pose{start_place(scene, joint.b), b.angle + joint.b.angle, line, curvature};
    const Hub& hub = hub_of(scene, joint);
    return Pose{hub.position, hub.angle + joint.angle, line, curvature};
  }
  if (!body.position) return {};
  const double line = body.longest(scene.time.end) - body.length;
  return Pose{*body.position, body.angle, line, curvature_of(body)};
}

/// The same, or where welds to bodies that have a place put it.
/// @param from  bodies that ask for it themselves
std::optional<Pose> known_pose(const Scene& scene, const Body& body,
                               std::vector<std::string> from = {}) {
  if (const auto own = own_pose(scene, body)) return own;
  from.push_back(body.name);
  for (const Joint& joint : scene.joints) {
    if (!joint.joins_edges() || (joint.a.body != body.name && joint.b.body != body.name)) continue;
    const bool at_a = joint.a.body == body.name;
    const Anchor &here = at_a ? joint.a : joint.b, &there = at_a ? joint.b : joint.a;
    if (std::find(from.begin(), from.end(), there.body) != from.end()) continue;
    const auto other = known_pose(scene, scene.body(there.body), from);
    if (!other) continue;
    Pose pose{{0, 0},
              other->angle + there.angle - here.angle,
              body.longest(scene.time.end) - body.length,
              curvature_of(body)};
    pose.origin = (other->place(there.point) - pose.place(here.point)).head<2>();
    return pose;
  }
  return {};
}

}  // namespace

Pose start_pose(const Scene& scene, const Body& body) {
  if (const auto known = known_pose(scene, body)) return *known;
  Pose pose;
  pose.curvature = curvature_of(body);
  return pose;
}

}  // namespace flexmorph::cases
