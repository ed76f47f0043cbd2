// Shows that the forces of springs, bushings, stops, torques and point forces equal values
// calculated by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fem/bushing.h"
#include "fem/force_element.h"
#include "fem/stop.h"
#include "tests/support/models.h"
#include "tests/support/rigid_models.h"

namespace flexmorph::fem {
namespace {

/// Returns the state with the rigid body "one" at r with the given angle and without velocities.
State placed(const Model& model, const Vec2& r, double angle) {
  State x = model.reference();
  testing::put(model, "one", {r, angle}, x);
  return x;
}

// The triangle has the sides 3, 4, 5 m: N = 3 (5 - 4) + 2 · l̇ with l̇ = (3 · 10)/5 = 6.
TEST(Spring, PullsAlongItsLine) {
  Workspace model;
  model.add_body("one", std::make_unique<RigidBody>(1), {}, {});
  model.add_force_element(
      make_spring("s", {.point = {1, 1}}, {.body = "one", .point = {0, 1}}, {3, 2, 4}));
  State x = placed(model, {4, 4}, 0);
  x.v[0] = 10;
  VectorXd f;
  model.force(x, f);
  EXPECT_NEAR(f[0], 15 * 0.6, 1e-13);
  EXPECT_NEAR(f[1], 15 * 0.8, 1e-13);
  EXPECT_NEAR(model.energies(x).strain, 1.5, 1e-14);
  EXPECT_NEAR(model.force_element_power(x), -2 * 36, 1e-12);
}

// d = (3, 4) in the axes of a, which are rotated by 90 degrees: the forces along the axes are 2 · 3
// and 5 · 4, and the moment is 7 (π/2 - 0.5).
TEST(Bushing, PushesAlongAndAcross) {
  const double quarter = 0.5 * std::numbers::pi;
  Workspace model;
  model.add_body("one", std::make_unique<RigidBody>(1), {}, {});
  model.add_force_element(make_bushing("b", {.point = {1, 1}, .angle = quarter}, {.body = "one"},
                                       {{2, 5}, {0.5, 0}, 7, 0, 0.5, {}}));
  State x = placed(model, {1 - 4, 1 + 3}, 2 * quarter);
  x.v[1] = 10;
  VectorXd f;
  model.force(x, f);
  EXPECT_NEAR(f[0], -20, 1e-13);
  EXPECT_NEAR(f[1], 6 + 5, 1e-13);
  EXPECT_NEAR(f.tail<2>().dot(Vec2(-x.q[3], x.q[2])), 7 * (quarter - 0.5), 1e-13);
  EXPECT_NEAR(model.energies(x).strain,
              0.5 * (2 * 9 + 5 * 16 + 7 * (quarter - 0.5) * (quarter - 0.5)), 1e-13);
  EXPECT_NEAR(model.force_element_power(x), -0.5 * 100, 1e-12);
}

// Between its limits the stop has no force; beyond the onset the force is k (δ - w/2). The stop
// never pulls at any rate: where damping would make it pull, the stored energy is dissipated as
// power.
TEST(Stop, PushesOnlyBeyondItsLimits) {
  Workspace model;
  model.add_body("one", std::make_unique<RigidBody>(1), {}, {});
  model.add_force_element(
      make_stop("s", {.point = {1, 0}}, {.body = "one"},
                {.least = -2, .most = 3, .stiffness = 10, .damping = 4, .onset = 0.5}));
  const auto force = [&](double z, double rate) {
    State x = placed(model, {1 + z, 7}, 0);
    x.v[0] = rate;
    VectorXd f;
    model.force(x, f);
    EXPECT_EQ(f[1], 0);
    EXPECT_TRUE(f.tail<2>().isZero());
    return f[0];
  };
  for (const double z : {-2.0, 0.0, 3.0}) EXPECT_EQ(force(z, 5), 0) << z;
  EXPECT_NEAR(force(4, 0), 10 * 0.75, 1e-13);
  EXPECT_NEAR(force(4, 2), 10 * 0.75 + 8, 1e-13);
  EXPECT_NEAR(force(3.25, 2), 10 * 0.0625 + 4, 1e-13);
  EXPECT_NEAR(force(-3, -2), -10 * 0.75 - 8, 1e-13);
  EXPECT_EQ(force(4, -20), 0);
  EXPECT_EQ(force(-3, 20), 0);
  State x = placed(model, {1 + 4, 7}, 0);
  x.v[0] = -20;
  EXPECT_NEAR(model.force_element_power(x), -20 * 10 * 0.75, 1e-12);
}

// The angle is the shortest one: from 0.9 π to -0.9 π it is 0.2 π, not -1.8 π.
TEST(TorsionSpring, WrapsItsAngle) {
  const double pi = std::numbers::pi;
  for (const auto& [turn, rest, expected] : {std::tuple{0.9 * pi, -0.9 * pi, -0.2 * pi},
                                             {-0.9 * pi, 0.9 * pi, 0.2 * pi},
                                             {0.5 * pi, -0.5 * pi, pi},
                                             {0.3, 0.1, 0.2}}) {
    Workspace model;
    model.add_body("one", std::make_unique<RigidBody>(1), {}, {});
    model.add_force_element(make_torsion_spring("s", {}, {.body = "one"}, {2, 0, rest}));
    const State x = placed(model, {0, 0}, turn);
    EXPECT_NEAR(model.energies(x).strain, expected * expected, 1e-13);
    // The moment is the work of the force in the rotation u̇ = J u.
    VectorXd f;
    model.force(x, f);
    const Vec2 turned(-x.q[3], x.q[2]);
    EXPECT_NEAR(std::abs(f.tail<2>().dot(turned)), std::abs(2 * expected), 1e-13);
    if (expected < pi) {
      EXPECT_GT(f.tail<2>().dot(turned) * expected, 0);
    }
  }
}

TEST(Torque, TurnsCounterClockwiseWithItsMoment) {
  Workspace model;
  testing::add_rigid(model, "one", {2, {0.3, 0.4}, 0.7});
  model.add_force_element(make_torque("t", {.body = "one"}, 5));
  const State x = placed(model, {1, 2}, 0.6);
  VectorXd f;
  model.force(x, f);
  EXPECT_NEAR(f.tail<2>().dot(Vec2(-x.q[3], x.q[2])), -5, 1e-14);
  EXPECT_LT(f.head<2>().norm(), 1e-15);
  model.scale_loads(0.5);
  model.force(x, f);
  EXPECT_NEAR(f.tail<2>().dot(Vec2(-x.q[3], x.q[2])), -2.5, 1e-14);
}

TEST(PointForce, IsTheGeneralizedForceOfItsPoint) {
  Workspace model;
  model.add_body("one", std::make_unique<RigidBody>(1), {}, {});
  model.add_force_element(make_point_force("f", {.body = "one", .point = {2, 3}}, Vec2(5, 7)));
  const State x = placed(model, {1, 2}, 0);
  VectorXd f;
  model.force(x, f);
  // The virtual work is δ(r + 2 u + 3 v) · F with v = (-u_y, u_x).
  EXPECT_TRUE(f.isApprox(Eigen::Vector4d(-5, -7, -(2 * 5 + 3 * 7), -(2 * 7 - 3 * 5)), 1e-14)) << f;
  EXPECT_NEAR(model.energies(x).potential, -(5 * 3 + 7 * 5), 1e-13);
  model.scale_loads(2);
  EXPECT_NEAR(model.energies(x).potential, -2 * (5 * 3 + 7 * 5), 1e-13);
}

TEST(Links, NameWhatTheyCannotUse) {
  const RigidBody one(1);
  const std::string name = "one";
  const BodyView view{&name, &one, 0};
  EXPECT_THROW(make_spring("s", {}, {.body = "arm"}, {1, 0, 0})->bind({&view, 1}), Error);
  EXPECT_THROW(make_spring("s", {}, {}, {1, 0, 0})->bind({&view, 1}), Error);
  EXPECT_THROW(make_spring("s", {}, {.body = "one"}, {-1, 0, 0}), Error);
  EXPECT_THROW(make_spring("s", {}, {.body = "one"}, {1, NAN, 0}), Error);
  EXPECT_THROW(make_torsion_spring("s", {}, {.body = "one"}, {1, -1, 0}), Error);
  EXPECT_THROW(make_bushing("b", {}, {.body = "one"}, {}), Error);
  EXPECT_THROW(make_bushing("b", {}, {.body = "one"}, {{-1, 0}, {0, 0}, 0, 0, 0, {}}), Error);
  EXPECT_THROW(make_stop("s", {}, {.body = "one"}, {.stiffness = 1}), Error);
  EXPECT_THROW(make_stop("s", {}, {.body = "one"}, {.most = 1}), Error);
  EXPECT_THROW(make_stop("s", {}, {.body = "one"}, {.least = 1, .most = 0, .stiffness = 1}), Error);
  EXPECT_THROW(make_point_force("f", {.body = "one"}, Vec2(INFINITY, 0)), Error);
  EXPECT_THROW(make_torque("t", {.body = "one"}, NAN), Error);

  Workspace model;
  model.add_body("one", std::make_unique<RigidBody>(1), {}, {});
  model.add_force_element(make_spring("s", {}, {.body = "one"}, {1, 0, 0.5}));
  VectorXd f;
  try {  // both ends of the spring are at the origin
    model.force(model.reference(), f);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), Error::Kind::numerical);
  }
  const State x = placed(model, {1, 0}, 0);
  model.add_force_element(make_torque("t", {.body = "one"}, 1));
  EXPECT_THROW(model.mean_force(x, x.q, x.q, f), Error);  // a torque has no mean force
}

}  // namespace
}  // namespace flexmorph::fem
