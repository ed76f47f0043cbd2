// Statics of models that are free to move: weight, springs and joints decide where they rest, and
// what nothing decides stays where it is.
#include <gtest/gtest.h>

#include <cmath>

#include "fem/body_joints.h"
#include "fem/link.h"
#include "fem/solve/statics.h"
#include "tests/support/rigid_models.h"

namespace flexmorph::fem {
namespace {

constexpr double kG = 9.81;

/// A rigid body whose centre of mass is 0.5 m along its first axis, hung at its origin.
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

// Misses by κ/ω² of the way, κ = 0.01 1/s², ω² = m g l / (J + m l²).
TEST(RestingEquilibrium, PendulumHangs) {
  const double down = -0.5 * 3.14159265358979, w2 = 2 * kG * 0.5 / (0.1 + 2 * 0.25);
  for (const double off : {0.0, 0.02, -0.3}) {
    Pendulum p(down + off);
    solve_resting_equilibrium(p.model, p.x);
    EXPECT_NEAR(p.angle(), down, 1.05 * 0.01 / w2 * std::abs(off) + 1e-12) << off;
    Constraints c;
    p.model.constraints(p.x, c);
    EXPECT_LT(c.value.lpNorm<Eigen::Infinity>(), 1e-12);
    EXPECT_EQ(p.x.v.norm() + p.x.a.norm(), 0);
    // The hook carries the weight.
    const Wrench w = p.model.joint_wrench(1, "bob", Vec3::Zero(), p.x);
    EXPECT_NEAR(w.force.y(), 2 * kG, 1e-3 * std::abs(off) * kG + 1e-10);
  }
}

TEST(RestingEquilibrium, SpringIsStretchedByTheWeight) {
  Pendulum p(0.01);
  const double k = 400;
  p.model.add_link(make_torsion_spring("spring", {}, {"bob"}, {k, 0, 0}));
  solve_resting_equilibrium(p.model, p.x);
  const double angle = p.angle();
  EXPECT_NEAR(k * angle, -2 * kG * 0.5 * std::cos(angle), 1e-3);  // κ (J + m l²) off at most
}

TEST(RestingEquilibrium, WhatNothingMovesStays) {
  Pendulum p(0.7, {0, 0});
  solve_resting_equilibrium(p.model, p.x);
  EXPECT_NEAR(p.angle(), 0.7, 1e-12);
}

}  // namespace
}  // namespace flexmorph::fem
