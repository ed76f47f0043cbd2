// Shows that the static equilibrium of models with remaining degrees of freedom is determined by
// weight, springs and joints, and that a degree of freedom without a restoring force does not
// change.
#include <gtest/gtest.h>

#include <cmath>

#include "fem/body_joints.h"
#include "fem/force_element.h"
#include "fem/solve/statics.h"
#include "tests/support/rigid_models.h"

namespace flexmorph::fem {
namespace {

constexpr double kG = 9.81;

/// A rigid body whose centre of mass is 0.5 m along its first axis, hinged at its origin.
struct Pendulum {
  explicit Pendulum(double angle, const Vec2& gravity = {0, -kG}) {
    testing::add_rigid(model, "bob", {2.0, {0.5, 0}, 0.1}, gravity);
    model.add_joint(make_revolute("hook", {}, {"bob"}));
    x = model.reference();
    x.q << 0, 0, std::cos(angle), std::sin(angle);
  }
  double angle() const { return std::atan2(x.q[3], x.q[2]); }
  Workspace model;
  State x;
};

// The error is κ/ω² of the initial offset, with κ = 0.01 1/s², ω² = m g l / (J + m l²).
TEST(RestingEquilibrium, PendulumHangs) {
  const double down = -0.5 * 3.14159265358979, w2 = 2 * kG * 0.5 / (0.1 + 2 * 0.25);
  for (const double off : {0.0, 0.02, -0.3}) {
    Pendulum p(down + off);
    solve_static_equilibrium(p.model, p.x);
    EXPECT_NEAR(p.angle(), down, 1.05 * 0.01 / w2 * std::abs(off) + 1e-12) << off;
    Constraints c;
    p.model.constraints(p.x, c);
    EXPECT_LT(c.value.lpNorm<Eigen::Infinity>(), 1e-12);
    EXPECT_EQ(p.x.v.norm() + p.x.a.norm(), 0);
    // The hinge carries the weight.
    const Wrench w = p.model.joint_wrench(1, "bob", Vec3::Zero(), p.x);
    EXPECT_NEAR(w.force.y(), 2 * kG, 1e-3 * std::abs(off) * kG + 1e-10);
  }
}

TEST(RestingEquilibrium, SpringIsStretchedByTheWeight) {
  Pendulum p(0.01);
  const double k = 400;
  p.model.add_force_element(make_torsion_spring("spring", {}, {"bob"}, {k, 0, 0}));
  solve_static_equilibrium(p.model, p.x);
  const double angle = p.angle();
  EXPECT_NEAR(k * angle, -2 * kG * 0.5 * std::cos(angle), 1e-3);  // tolerance: κ (J + m l²) at most
}

TEST(RestingEquilibrium, WhatNothingMovesStays) {
  Pendulum p(0.7, {0, 0});
  solve_static_equilibrium(p.model, p.x);
  EXPECT_NEAR(p.angle(), 0.7, 1e-12);
}

}  // namespace
}  // namespace flexmorph::fem
