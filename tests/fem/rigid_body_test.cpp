// Shows that mass, weight and momentum of a rigid body equal those of its points, and that joint
// forces and their wrenches are the reactions of mechanics.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <iostream>

#include "fem/dynamics/integrators/generalized_alpha.h"
#include "fem/dynamics/motion.h"
#include "fem/loads.h"
#include "fem/solve/statics.h"
#include "fem/terms.h"
#include "tests/support/differences.h"
#include "tests/support/models.h"
#include "tests/support/rigid_models.h"

namespace flexmorph::fem {
namespace {

using testing::first_difference;
using testing::ShapeSet;

struct Points {
  std::vector<Vec2> at = {{0.3, 0.1}, {-0.2, 0.4}, {0.5, -0.3}, {0.1, 0.2}};
  std::vector<double> mass = {1.3, 0.4, 2.1, 0.7};

  RigidSection section() const {
    RigidSection s{0, {0, 0}, 0};
    for (size_t i = 0; i < at.size(); ++i) {
      s.mass += mass[i];
      s.center += mass[i] * at[i];
    }
    s.center /= s.mass;
    for (size_t i = 0; i < at.size(); ++i) s.inertia += mass[i] * (at[i] - s.center).squaredNorm();
    return s;
  }
};

// Energies and momentum must equal those of four point masses for any q and q̇ (u of any length,
// too).
TEST(RigidBody, IsTheSumOfItsPoints) {
  const Points points;
  const VectorXd given = Vec2(1.2, -9.81);
  Workspace model;
  testing::add_rigid(model, "body", points.section(), given);
  const Vec2 gravity = testing::disturbed(given);  // add_rigid() disturbs gravity, too
  model.prepare(0.0);
  State x = model.reference();
  x.q.setRandom();
  x.v.setRandom();
  x.a.setRandom();
  double kinetic = 0, potential = 0;
  Vec2 momentum(0, 0);
  for (size_t i = 0; i < points.at.size(); ++i) {
    Eigen::Matrix2d arm;
    arm << points.at[i].x(), -points.at[i].y(), points.at[i].y(), points.at[i].x();
    const Vec2 r = x.q.head<2>() + arm * x.q.tail<2>(), v = x.v.head<2>() + arm * x.v.tail<2>();
    kinetic += 0.5 * points.mass[i] * v.squaredNorm();
    potential -= points.mass[i] * gravity.dot(r);
    momentum += points.mass[i] * v;
  }
  const Energies e = model.energies(x);
  EXPECT_NEAR(e.kinetic, kinetic, 1e-14);
  EXPECT_NEAR(e.potential, potential, 1e-13);
  EXPECT_LT((Vec2(model.momentum(x).head<2>()) - momentum).norm(), 1e-14);

  // The force is M q̈ + V_q, where M is the second derivative of T.
  const VectorXd direction = VectorXd::Random(4);
  const auto energy_by_v = [&](double by) {
    State y = x;
    y.v = x.a + by * direction;
    return model.energies(y).kinetic;
  };
  const auto energy_by_q = [&](double by) {
    State y = x;
    y.q += by * direction;
    return model.energies(y).potential;
  };
  VectorXd force;
  model.force(x, force);
  EXPECT_NEAR(force.dot(direction),
              first_difference(energy_by_v, 0.1) + first_difference(energy_by_q, 0.1), 1e-12);
  model.scale_loads(0);
  EXPECT_EQ(model.energies(x).potential, 0);
}

// A marker that moves along a ray of a rotating body has the velocity and acceleration of polar
// coordinates.
TEST(LocationMotion, OfAShiftedLocationIsThatOfPolarCoordinates) {
  Workspace model;
  testing::add_rigid(model, "body", {.mass = 1, .inertia = 1});
  State x = model.reference();
  x.t = 0.7;
  testing::put(model, "body", {{0, 0}, 0.4, {0, 0}, 1.3, {0, 0}, -0.6}, x);
  const auto along = [](double t) { return Motion{t * t, 2 * t, 2}; };
  const LocationMotion p = model.location_motion({.body = "body", .angle = 0.9, .along = along}, x);
  const double s = 0.49, s_t = 1.4, s_tt = 2, w = 1.3, w_t = -0.6;
  const Vec2 e(std::cos(1.3), std::sin(1.3)), n(-e.y(), e.x());
  EXPECT_LT((p.position - s * e).norm(), 1e-15);
  EXPECT_LT((p.axis - e).norm(), 1e-15);
  EXPECT_LT((p.velocity - s_t * e - s * w * n).norm(), 1e-15);
  EXPECT_LT((p.acceleration - (s_tt - s * w * w) * e - (s * w_t + 2 * s_t * w) * n).norm(), 1e-14);
  EXPECT_THROW(model.location_motion({.body = "arm"}, x), Error);
}

TEST(RigidBody, RefusesWhatItIsNot) {
  EXPECT_THROW(RigidBody(0), Error);
  EXPECT_THROW(make_rigid_inertia({-1, {0, 0}, 1}), Error);
  EXPECT_THROW(make_rigid_inertia({1, {0, 0}, 0}), Error);
  EXPECT_THROW(make_rigid_gravity({1, {0, 0}, 1}, Vec3(0, 0, -9.81)), Error);
  EXPECT_THROW(RigidBody(1).edge("root"), Error);
  ShapeTable table;
  EXPECT_THROW(RigidBody(1).locate({0, 0}, Tabulate::position, table), Error);
  Workspace model;
  std::vector<std::unique_ptr<Term>> terms;
  terms.push_back(make_rigid_inertia({.mass = 1, .inertia = 1}));
  model.add_body("plate",
                 std::make_unique<AncfPlate>(2, ShapeSet::h16, testing::uniform_lines(0, 1, 1),
                                             testing::uniform_lines(0, 1, 1)),
                 {}, std::move(terms));
  EXPECT_THROW(model.prepare(0.0), Error);
  Workspace bodies;
  testing::add_rigid(bodies, "body", {.mass = 1, .inertia = 1});
  EXPECT_EQ(bodies.smallest_area_ratio(bodies.reference()),
            std::numeric_limits<double>::infinity());  // a rigid body has no sampled area
}

// A rotating body has a hinge that is not its point r: the reaction is m (r̈_c - g), it has no
// moment about the hinge, and its moment about r is force times lever.
TEST(JointForce, OfAHingeIsTheReaction) {
  const RigidSection section{3, {0.4, -0.1}, 0.2};
  const Vec2 gravity(0, -9.81), hinge(-0.3, 0.2);
  Workspace model;
  testing::add_rigid(model, "body", section, gravity);
  model.add_joint(make_revolute("hinge", {.point = {1, 2}}, {.body = "body", .point = hinge}));
  ASSERT_EQ(model.joints()[1]->name(), "hinge");
  EXPECT_EQ(model.first_row(1), 1);
  EXPECT_EQ(model.first_row(2), 3);

  State x = model.reference();
  const double angle = 0.7, rate = 2.5;
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(angle).toRotationMatrix();
  const Vec2 r = Vec2(1, 2) - turn * hinge, lever = turn * (section.center - hinge);
  const auto quarter = [](const Vec2& v) { return Vec2(-v.y(), v.x()); };
  testing::put(model, "body", {r, angle, rate * quarter(r - Vec2(1, 2)), rate}, x);
  GeneralizedAlpha alpha(model, {});
  alpha.make_consistent(x);

  // θ̈ = moment of the weight about the hinge / moment of inertia about the hinge.
  const double about_hinge = section.inertia + section.mass * lever.squaredNorm();
  const double spin =
      section.mass * (lever.x() * gravity.y() - lever.y() * gravity.x()) / about_hinge;
  const Vec2 reaction = section.mass * (spin * quarter(lever) - rate * rate * lever - gravity);
  EXPECT_LT((x.lambda.tail<2>() + reaction).norm(), 1e-12);
  const Wrench w = model.joint_wrench(1, "body", {1, 2, 0}, x);
  EXPECT_LT((w.force - Vec3(reaction.x(), reaction.y(), 0)).norm(), 1e-12);
  EXPECT_LT(w.moment.norm(), 1e-12);
  const Vec2 arm = Vec2(1, 2) - r;
  EXPECT_NEAR(model.joint_wrench(1, "body", {r.x(), r.y(), 0}, x).moment.z(),
              arm.x() * reaction.y() - arm.y() * reaction.x(), 1e-12);
  // The constraint of the unit axis does no work in motions of the body.
  const Wrench none = model.joint_wrench(0, "body", {5, 6, 0}, x);
  EXPECT_LT(none.force.norm() + none.moment.norm(), 1e-12);
  EXPECT_THROW(model.joint_wrench(1, "arm", {0, 0, 0}, x), Error);
}

// A body hangs on two parallel springs; the force k (l - l₀) of each is half of the weight.
TEST(Statics, OfABodyOnSprings) {
  Workspace model;
  testing::add_rigid(model, "body", {4, {0, -0.2}, 0.3}, Vec2(0, -9.81));
  for (const double x : {-0.5, 0.5})
    model.add_force_element(
        make_spring("spring", {.point = {x, 1}}, {.body = "body", .point = {x, 0}}, {300, 5, 0.9}));
  State x = model.reference();
  x.q[1] = 0.03;
  x.q.tail<2>() << std::cos(0.05), std::sin(0.05);
  model.prepare(x);
  StaticSettings settings;
  settings.from = 0.5;  // without weight the sideways position is not determined
  const StaticResult result = solve_static(model, x, settings);
  EXPECT_TRUE(result.completed);
  EXPECT_NEAR(x.q[1], 1 - (0.9 + 0.5 * 4 * 9.81 / 300), 1e-9);
  EXPECT_LT((x.q - Eigen::Vector4d(0, x.q[1], 1, 0)).norm(), 1e-9);
}

}  // namespace
}  // namespace flexmorph::fem
