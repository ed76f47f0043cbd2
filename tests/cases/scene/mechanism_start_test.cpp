// Shows that mechanisms whose drives leave degrees of freedom start in static equilibrium: the
// crane's arm deflects as a beam, its load hangs under the hook, and the joints carry the whole
// weight.
#include <gtest/gtest.h>

#include <cmath>

#include "cases/assembly/build.h"
#include "cases/results/motion_columns.h"
#include "fem/dynamics/starts/rigid_motion.h"
#include "tests/cases/scenes.h"
#include "tests/support/errors.h"

namespace flexmorph::cases {
namespace {

constexpr double kG = 9.81, kAngle = 0.3;

class Crane : public ::testing::Test {
 protected:
  Crane() : scene(read("telescopic_crane")), crane(build_mechanism(scene)) {
    x = fem::start_state(crane.model, crane.moving_roots, 0, crane.motion.start,
                         crane.motion.body_poses);
    const auto integrator = fem::make_integrator(crane.model, {});
    integrator->project_velocity(x);
    integrator->make_consistent(x);
  }
  Scene scene;
  Mechanism crane;
  fem::State x;
};

TEST_F(Crane, RigidModelHasTheSwingAsItsOnlyFreedom) {
  fem::RigidMotion rigid(rigid_kinematics(scene));
  EXPECT_EQ(rigid.degrees_of_freedom(), 1);
  EXPECT_LT(rigid.start_speed(), 1e-12);
  // The positions in the case have three digits: the distance of the hanging load differs by 0.001
  // from 0.3 m.
  EXPECT_LT(rigid.start_acceleration(), 0.005 * kG);
  EXPECT_EQ(crane.motion.start, fem::Start::settled);
}

TEST_F(Crane, RestsAtItsStart) {
  EXPECT_LT(x.v.lpNorm<Eigen::Infinity>(), 1e-12);
  EXPECT_LT(crane.model.scales().cwiseProduct(x.a).lpNorm<Eigen::Infinity>(), 1e-5 * kG);
  fem::Constraints c;
  crane.model.constraints(x, c);
  EXPECT_LT(c.value.lpNorm<Eigen::Infinity>(), 1e-12);
  const fem::FrameMotion load = fem::frame_of(crane.model.body("load"), x),
                         tip = fem::frame_of(crane.model.body("tip"), x);
  EXPECT_NEAR(load.angle, 0, 1e-5);
  EXPECT_NEAR(load.origin.x(), tip.origin.x(), 1e-6);
}

// Reference: Timoshenko's cantilever under its own weight and the weight of tip and load, 0.05 m
// beyond its end.
TEST_F(Crane, ArmSagsAsABeam) {
  const double L = 0.6, EI = 7e9 * 0.01 * 1e-3 / 12, GA = 7e9 / 2.6 * 1e-3 / 1.2;
  const double P = 10.5 * kG * std::cos(kAngle), w = 2700 * 1e-3 * kG * std::cos(kAngle);
  const double sag = P * L * L * L / (3 * EI) + P * 0.05 * L * L / (2 * EI) +
                     w * std::pow(L, 4) / (8 * EI) + (P * L + 0.5 * w * L * L) / GA;
  EXPECT_NEAR(-tip_deflection(crane.model, crane.moving_roots.at(0), x) / sag, 1, 0.01);
}

// The loads of the design problem are the weight of tip and load at the free end and its moment.
TEST_F(Crane, LoadsOfTheArmCarryTheWeight) {
  const fem::Body& arm = crane.model.body("arm");
  const auto attached = attached_joints(scene, "arm");
  ASSERT_EQ(attached.size(), 1u);
  const auto forces = fem::joint_forces(crane.model, x, arm, attached);
  const double weight = 10.5 * kG;
  EXPECT_NEAR(forces[0].force.x(), 0, 1e-4 * weight);
  EXPECT_NEAR(forces[0].force.y(), -weight, 1e-4 * weight);
  const double lever = fem::frame_of(crane.model.body("tip"), x).origin.x() -
                       fem::point_position(arm, x, {1.0, 0}).x();
  EXPECT_NEAR(lever, 0.05 * std::cos(kAngle), 1e-3);
  EXPECT_NEAR(forces[0].moment, -weight * lever, 1e-4 * weight);

  const fem::EslSet set =
      fem::equivalent_static_load(crane.model, x, crane.moving_roots.at(0),
                                  scene.designs.at(0).grid, {}, forces, crane.motion.gravity);
  Vec2 sum(0, 0);
  double moment = 0;  // about the middle of the free end
  const Grid& grid = scene.designs[0].grid;
  for (const fem::NodalForce& f : set.forces) {
    sum += f.force;
    moment -= (grid.y0 + (f.node % (grid.ny + 1)) * grid.dy()) * f.force.x();
    EXPECT_EQ(f.node / (grid.ny + 1), grid.nx);
  }
  const Vec2 in_the_base = fem::rotation(kAngle).transpose() * Vec2(0, -weight);
  EXPECT_NEAR((sum - in_the_base).norm(), 0, 1e-4 * weight);
  EXPECT_NEAR(moment, -weight * lever, 2e-4 * weight);
  // The only other force is the arm's own weight, because nothing moves.
  const int last = grid.nx * (grid.ny + 1);
  const Vec2 own = fem::rotation(kAngle).transpose() * Vec2(0, kG);
  EXPECT_NEAR((set.acceleration.segment<2>(2 * last) - own).norm(), 0, 1e-3 * kG);
}

// The motion continues from this start without vibration: within the first 0.02 s the drives move
// the arm by 1e-5 of their travel.
TEST_F(Crane, DoesNotRing) {
  crane.motion.end = 0.02;
  double least = 1e9, most = 0, kinetic = 0;
  fem::integrate(crane.model, crane.moving_roots, crane.motion, [&](const fem::MotionStep& step) {
    least = std::min(least, step.energies.strain);
    most = std::max(most, step.energies.strain);
    kinetic = std::max(kinetic, step.energies.kinetic);
  });
  EXPECT_LT(most / least - 1, 0.01);
  EXPECT_LT(kinetic, 1e-4 * least);
}

TEST(MechanismStart, WhatSetsOffIsRefusedInWords) {
  const Scene scene = read("telescopic_crane", {"gravity=[3.0, -9.81]", "time.start=prestretched"});
  EXPECT_THROW(
      {
        try {
          build_mechanism(scene);
        } catch (const Error& error) {
          EXPECT_EQ(error.kind(), Error::Kind::input);
          EXPECT_TRUE(testing::mentions_all(error.what(),
                                            {"prestretched", "2.93 m/s²", "start = \"rigid\""},
                                            "--set time.start=prestretched: "));
          throw;
        }
      },
      Error);
  EXPECT_EQ(build_mechanism(read("telescopic_crane", {"gravity=[3.0, -9.81]", "time.start=rigid"}))
                .motion.start,
            fem::Start::rigid);
  EXPECT_EQ(build_mechanism(read("four_bar", {"time.start=prestretched"})).motion.start,
            fem::Start::prestretched);
}

// Reference: the initial angular acceleration of the crane's pendulum is m g l sin φ / (J + m l²).
TEST(MechanismStart, RigidAccelerationIsThatOfAPendulum) {
  const Scene scene = read("telescopic_crane", {"gravity=[9.81, -9.81]", "time.start=rigid"});
  const double J = 10 * (2 * 0.12 * 0.12) / 12, l = 0.3, m = 10;
  const double turn = m * kG * l / (J + m * l * l);  // only the horizontal component accelerates it
  // The rotation is scaled by the radius of gyration, and the centre of mass moves by l.
  EXPECT_NEAR(fem::RigidMotion(rigid_kinematics(scene)).start_acceleration() / (turn * l), 1, 0.01);
}

}  // namespace
}  // namespace flexmorph::cases
