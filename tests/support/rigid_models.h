#pragma once

#include <cmath>
#include <string>

#include "fem/body_joints.h"
#include "fem/elements/rigid_body.h"
#include "fem/model/workspace.h"
#include "fem/rigid.h"
#include "tests/support/disturbance.h"

/// Planar rigid bodies that tests create and place directly.
namespace flexmorph::testing {

/// Adds a rigid body with mass, and with weight if gravity is given, and the joint that keeps its
/// axis at unit length.
inline void add_rigid(fem::Workspace& model, const std::string& name,
                      const fem::RigidSection& section, const VectorXd& gravity = {}) {
  std::vector<std::unique_ptr<fem::Term>> terms;
  terms.push_back(fem::make_rigid_inertia(section));
  if (gravity.size() > 0) terms.push_back(fem::make_rigid_gravity(section, disturbed(gravity)));
  model.add_body(name, std::make_unique<fem::RigidBody>(std::sqrt(section.inertia / section.mass)),
                 {}, std::move(terms));
  model.add_joint(fem::make_unit_axis("unit axis of " + name, name));
}

/// Position of the reference point r and angle of a rigid body, with their rates.
struct Pose {
  Vec2 r{0, 0};
  double angle = 0;
  Vec2 velocity{0, 0};
  double angle_rate = 0;
  Vec2 acceleration{0, 0};
  double angle_acceleration = 0;
};

inline void put(const fem::Model& model, const std::string& name, const Pose& pose, fem::State& x) {
  const int at = model.body(name).first_dof;
  const Vec2 u(std::cos(pose.angle), std::sin(pose.angle)), v(-u.y(), u.x());
  x.q.segment<4>(at) << pose.r, u;
  x.v.segment<4>(at) << pose.velocity, pose.angle_rate * v;
  x.a.segment<4>(at) << pose.acceleration,
      pose.angle_acceleration * v - pose.angle_rate * pose.angle_rate * u;
}

/// Returns the angle of a rigid body in (-π, π].
inline double angle_of(const fem::Model& model, const std::string& name, const fem::State& x) {
  const int at = model.body(name).first_dof;
  return std::atan2(x.q[at + 3], x.q[at + 2]);
}
inline double angle_rate_of(const fem::Model& model, const std::string& name, const fem::State& x) {
  const int at = model.body(name).first_dof;
  return x.q[at + 2] * x.v[at + 3] - x.q[at + 3] * x.v[at + 2];
}

}  // namespace flexmorph::testing
