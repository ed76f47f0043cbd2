// Shows that the rigid kinematic model gives the closed forms of a four-bar, a slider-crank and a
// polar arm: motion, initial velocities, and drives that follow from a path. Shows also that
// impossible motions are refused, that copies are independent, and that welds place undeformed
// bodies correctly.
#include "fem/dynamics/starts/rigid_motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fem/body_joints.h"
#include "fem/dynamics/starts/inverse_kinematics.h"
#include "fem/dynamics/starts/reference_pose.h"
#include "tests/support/differences.h"
#include "tests/support/point_mechanisms.h"

namespace flexmorph::fem {
namespace {

using testing::Course;
using testing::first_difference;
using testing::linear;

/// Returns a slender rod that extends from its origin along its first axis.
MechanismBody rod(const std::string& name, double length, const Vec2& at, double angle) {
  MechanismBody out;
  out.name = name;
  out.section = {1, {length / 2, 0}, length * length / 12};
  out.size = length / std::sqrt(12.0);
  out.position = at;
  out.angle = angle;
  return out;
}

void hinge(RigidMechanism& out, const std::string& name, MarkerLocation a, MarkerLocation b) {
  out.joints.push_back({.joint = make_revolute(name, std::move(a), std::move(b))});
}

/// Adds an angle drive between two bodies; without a course its motion is not prescribed yet.
void turn(RigidMechanism& out, const std::string& drive, const MarkerLocation& a,
          const MarkerLocation& b, const Course& course) {
  MechanismJoint joint{.joint = {}, .is_driven = true, .drive = drive, .prescribes = true};
  if (course) joint.joint = make_angle_drive(drive, a, b, course);
  joint.coordinate = angle_between;
  joint.a = a;
  joint.b = b;
  out.joints.push_back(std::move(joint));
}

double direction(const Vec2& from, const Vec2& to) {
  return std::atan2(to.y() - from.y(), to.x() - from.x());
}

/// Returns a four-bar whose initial angles have errors of 0.1 rad.
RigidMechanism four_bar(const testing::FourBar& bar, const Course& angle) {
  const double start = angle(0).value, off = 0.1;
  const Vec2 a = bar.crank_pin(start), b = bar.rocker_pin(start), c(bar.g, 0);
  RigidMechanism out;
  out.bodies = {rod("crank", bar.r, {0, 0}, start + off),
                rod("coupler", bar.l, a, direction(a, b) - off),
                rod("rocker", bar.s, c, direction(c, b) + off)};
  hinge(out, "O", {}, {"crank"});
  hinge(out, "A", {"crank", {bar.r, 0}}, {"coupler"});
  hinge(out, "B", {"coupler", {bar.l, 0}}, {"rocker", {bar.s, 0}});
  hinge(out, "C", {"", c}, {"rocker"});
  turn(out, "motor", {}, {"crank"}, angle);
  return out;
}

TEST(RigidMotion, FourBarClosesAtAllTimes) {
  const testing::FourBar bar;
  const Course angle = linear(0.7, 2 * std::numbers::pi);
  const RigidKinematics kinematics(four_bar(bar, angle));
  EXPECT_EQ(undriven_degrees_of_freedom(kinematics), 1);
  RigidMotion motion(kinematics);
  EXPECT_EQ(motion.degrees_of_freedom(), 0);
  EXPECT_FALSE(motion.is_indeterminate());
  for (const double t : {0.0, 0.13, 0.5, 1.21}) {
    const State& x = motion.at(t);
    const auto closed = [&](double s) { return bar.rocker_pin(angle(t + s).value); };
    const FrameMotion rocker = kinematics.frame("rocker", x);
    const Vec2 arm = rotation(rocker.angle) * Vec2(bar.s, 0), end = rocker.origin + arm;
    EXPECT_LT((end - closed(0)).norm(), 1e-12) << t;
    const Vec2 rate = rocker.angle_rate * Vec2(-arm.y(), arm.x());
    EXPECT_LT((rate - first_difference(closed, 1e-3)).norm(), 1e-7) << t;
    EXPECT_NEAR(kinematics.coordinate_of("motor", x).rate, 2 * std::numbers::pi, 1e-11);
  }
  EXPECT_NO_THROW(require_motion(kinematics, 1));
}

// The rods are too short for a rotation of the crank beyond its limit angle.
TEST(RigidMotion, IsRefusedWhereItsDrivesCannotLeadIt) {
  const testing::FourBar bar{.r = 0.3, .l = 0.35, .s = 0.25, .g = 0.45};
  const RigidKinematics kinematics(four_bar(bar, linear(0.5, 1.3)));
  EXPECT_NO_THROW(require_motion(kinematics, 0.9 * (bar.limit_angle() - 0.5) / 1.3));
  EXPECT_THROW(require_motion(kinematics, 4), Error);
}

TEST(RigidMotion, CopiesOfAModelAreIndependent) {
  const testing::FourBar bar;
  auto original =
      std::make_unique<RigidKinematics>(four_bar(bar, linear(0.7, 2 * std::numbers::pi)));
  RigidMotion alone(*original);
  const VectorXd early = alone.at(0.2).q, late = alone.at(0.9).q;
  RigidMotion one(*original), other(*original);
  original.reset();
  for (int k = 0; k < 3; ++k) {
    EXPECT_LT((one.at(0.2).q - early).norm(), 1e-11);
    EXPECT_LT((other.at(0.9).q - late).norm(), 1e-11);
  }
}

/// Returns a crank of length r that rotates about the origin, a rod of length l, and a block on the
/// x axis.
RigidMechanism slider_crank(double r, double l, double angle) {
  RigidMechanism out;
  const double x = r * std::cos(angle) + std::sqrt(l * l - std::pow(r * std::sin(angle), 2));
  const Vec2 pin(r * std::cos(angle), r * std::sin(angle));
  out.bodies = {rod("crank", r, {0, 0}, angle), rod("rod", l, pin, direction(pin, {x, 0})),
                rod("block", 0.1, {x, 0}, 0)};
  hinge(out, "O", {}, {"crank"});
  hinge(out, "A", {"crank", {r, 0}}, {"rod"});
  hinge(out, "B", {"rod", {l, 0}}, {"block"});
  out.joints.push_back({.joint = make_slider("guide", {}, {"block"})});
  return out;
}

/// Returns dx/dθ of the block.
double block_rate(double r, double l, double angle) {
  const double s = std::sin(angle), c = std::cos(angle);
  return -r * s - r * r * s * c / std::sqrt(l * l - r * r * s * s);
}

TEST(InitialVelocities, OfASliderCrankFollowFromThatOfItsCrank) {
  const double r = 0.2, l = 0.5, angle = 1.1, rate = 3;
  RigidMechanism mechanism = slider_crank(r, l, angle);
  mechanism.bodies[0].angular_velocity = rate;
  RigidMotion motion{RigidKinematics(mechanism)};
  EXPECT_EQ(motion.degrees_of_freedom(), 1);
  // without drives, any time gives the start
  const FrameMotion block = motion.kinematics().frame("block", motion.at(5));
  EXPECT_NEAR(block.origin_rate.x(), rate * block_rate(r, l, angle), 1e-11);
  EXPECT_NEAR(block.origin_rate.y(), 0, 1e-11);
  EXPECT_GE(motion.start_speed(), std::abs(block.origin_rate.x()) - 1e-12);
}

TEST(InitialVelocities, OfAllMotionsTheOneOfLeastKineticEnergyIsTaken) {
  RigidMechanism mechanism = slider_crank(0.2, 0.5, 1.1);
  RigidMotion stagnates{RigidKinematics(mechanism)};
  EXPECT_LT(stagnates.start_speed(), 1e-12);
  mechanism.bodies[2].velocity = Vec2(-0.4, 0);
  RigidMotion moves{RigidKinematics(mechanism)};
  EXPECT_NEAR(moves.kinematics().frame("crank", moves.at(0)).angle_rate,
              -0.4 / block_rate(0.2, 0.5, 1.1), 1e-10);
}

TEST(InitialVelocities, ThatContradictJointsAreRefusedWithTheirSource) {
  RigidMechanism mechanism = slider_crank(0.2, 0.5, 1.1);
  mechanism.bodies[2].velocity = Vec2(0.3, 0.1);  // not along the guide
  mechanism.bodies[2].source = "crank.toml:7: ";
  try {
    RigidMotion motion{RigidKinematics(mechanism)};
    ADD_FAILURE() << "not refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), Error::Kind::input);
    const std::string text = error.what();
    EXPECT_EQ(text.find("crank.toml:7: block.velocity"), 0u) << text;
    EXPECT_NE(text.find("'guide'"), std::string::npos) << text;
  }
}

TEST(RigidMotion, RedundantJointsAreFollowedAndContradictionsRefused) {
  RigidMechanism mechanism = slider_crank(0.2, 0.5, 1.1);
  RigidMechanism twice = mechanism;
  hinge(twice, "again", {}, {"crank"});
  for (const bool bends : {false, true}) {
    twice.bends = bends;
    RigidMotion motion{RigidKinematics(twice)};
    EXPECT_TRUE(motion.is_indeterminate());
    EXPECT_EQ(motion.degrees_of_freedom(),
              RigidMotion{RigidKinematics(mechanism)}.degrees_of_freedom());
  }
  hinge(mechanism, "elsewhere", {"", {0.01, 0}}, {"crank"});
  EXPECT_THROW(RigidMotion{RigidKinematics(mechanism)}, Error);
}

TEST(RigidMotion, ListsTheBodiesThatRideInNoHub) {
  RigidMechanism mechanism = slider_crank(0.2, 0.5, 1.1);
  mechanism.bodies[1].line = 0.5;
  mechanism.bodies[2].is_placed = false;
  const BodyPoses where = rigid_configuration(RigidKinematics(mechanism));
  const std::vector<BodyPose> bodies = where(0);
  ASSERT_EQ(bodies.size(), 2u);
  EXPECT_EQ(bodies[1].body, "rod");
  EXPECT_EQ(bodies[1].line, 0.5);
  EXPECT_NEAR(bodies[0].frame.angle, 1.1, 1e-12);
  // A copy that moves to another time does not change the original and gives equal positions.
  const BodyPoses copy = where;
  copy(0.3);
  const std::vector<BodyPose> again = where(0), later = where(0.3), other = copy(0.3);
  EXPECT_EQ(again[1].frame.origin, bodies[1].frame.origin);
  EXPECT_NEAR((later[1].frame.origin - other[1].frame.origin).norm(), 0, 1e-12);
}

/// Returns a carriage on an arm that rotates about the origin, and a hand that rotates on the
/// carriage. The drives "turn", "reach" and "wrist" move it to any pose.
RigidMechanism polar_arm(const Vec2& hand, double angle) {
  RigidMechanism out;
  const double theta = direction({0, 0}, hand);
  out.bodies = {rod("arm", 1, {0, 0}, theta), rod("carriage", 0.1, hand, theta),
                rod("hand", 0.2, hand, angle)};
  hinge(out, "shoulder", {}, {"arm"});
  out.joints.push_back({.joint = make_slider("rail", {"arm"}, {"carriage"})});
  hinge(out, "pivot", {"carriage"}, {"hand"});
  turn(out, "turn", {}, {"arm"}, {});
  turn(out, "wrist", {"carriage"}, {"hand"}, {});
  MechanismJoint reach{.joint = {}, .is_driven = true, .drive = "reach", .prescribes = true};
  reach.coordinate = distance_between;
  reach.b = {"carriage"};
  out.joints.push_back(std::move(reach));
  return out;
}

// The hand moves around the shoulder, so that the angle of the arm passes π. Between samples, 1e-3
// s apart, the quintics have an error of 1e-18 times the sixth derivative; the positions have an
// error of 1e-12.
TEST(InverseKinematics, OfAPolarArmIsItsClosedForm) {
  const double rate = 4;
  const Course x = [=](double t) {
    const double c = 0.5 * std::cos(rate * t), s = 0.5 * std::sin(rate * t);
    return Motion{0.2 + c, -rate * s, -rate * rate * c};
  };
  const Course y = [=](double t) {
    const double c = 0.5 * std::cos(rate * t), s = 0.5 * std::sin(rate * t);
    return Motion{0.1 + s, rate * c, -rate * rate * s};
  };
  const std::vector<std::string> names = {"reach", "turn", "wrist"};
  const auto drives =
      inverse_kinematics(polar_arm({0.7, 0.1}, 0.3), {"hand", x, y, linear(0.3, 0.9), 2}, names);
  ASSERT_EQ(drives.size(), 3u);
  double turned = std::atan2(0.1, 0.7);
  for (double t = 0; t < 2; t += 0.01234) {
    const Vec2 r(x(t).value, y(t).value), v(x(t).rate, y(t).rate);
    const double angle = std::atan2(r.y(), r.x());
    turned += std::remainder(angle - turned, 2 * std::numbers::pi);
    EXPECT_NEAR(drives[0](t).value, r.norm(), 1e-11) << t;
    EXPECT_NEAR(drives[0](t).rate, r.dot(v) / r.norm(), 1e-10) << t;
    EXPECT_NEAR(drives[1](t).value, turned, 1e-11) << t;
    EXPECT_NEAR(drives[1](t).rate, (r.x() * v.y() - r.y() * v.x()) / r.squaredNorm(), 1e-9) << t;
    EXPECT_NEAR(drives[2](t).value, 0.3 + 0.9 * t - turned, 1e-11) << t;
  }
  for (double t = 0.1; t < 1.9; t += 0.31)
    for (const auto& drive : drives) {
      const auto value = [&](double s) { return drive(t + s).rate; };
      EXPECT_NEAR(drive(t).acceleration, first_difference(value, 1e-3), 1e-6) << t;
    }
  EXPECT_GT(turned, 2 * std::numbers::pi);
}

TEST(InverseKinematics, ADriveThatDrivesNothingIsRefused) {
  const std::vector<std::string> names = {"reach", "turn", "wrist", "spare"};
  const Course still = testing::constant(0.5);
  EXPECT_THROW(
      inverse_kinematics(polar_arm({0.5, 0.5}, 0.5), {"hand", still, still, still, 1}, names),
      Error);
}

TEST(InverseKinematics, OnlyItKnowsWhatDrivesWithoutAMotionDo) {
  EXPECT_THROW(RigidKinematics(polar_arm({0.5, 0.5}, 0.5)), Error);
}

// A quarter of a circle of radius R begins at the origin, rotated by 0.3. A straight body continues
// it at its end, and the root of a third body is welded perpendicularly to the free end of the
// straight one.
TEST(ReferencePose, GoesOnAlongWelds) {
  const double R = 0.8, quarter = 0.5 * std::numbers::pi * R, angle = 0.3;
  const std::vector<UndeformedBody> bodies = {
      {"last", 0, 0, {}},
      {"arc", 0, 1 / R, ReferencePose{{0, 0}, angle, 0, 1 / R}},
      {"straight", 0.2, 0, {}}};
  const std::vector<ReferenceWeld> welds = {
      {{"straight", {1.2, 0}, 0.5 * std::numbers::pi}, {"last", {0, 0}, 0}},
      {{"arc", {quarter, 0}, 0.5 * std::numbers::pi}, {"straight", {0, 0}, 0}}};
  const Vec2 corner = rotation(angle) * Vec2(R, R);
  const ReferencePose straight = reference_pose(bodies, welds, "straight"),
                      last = reference_pose(bodies, welds, "last");
  EXPECT_LT((straight.location({0, 0}).head<2>() - corner).norm(), 1e-15);
  EXPECT_NEAR(straight.angle, angle + 0.5 * std::numbers::pi, 1e-15);
  EXPECT_EQ(straight.line, 0.2);
  const Vec2 up = rotation(straight.angle) * Vec2(1, 0);
  EXPECT_LT((last.origin - (corner + 1.2 * up)).norm(), 1e-15);
  EXPECT_NEAR(last.angle, angle + std::numbers::pi, 1e-15);
}

TEST(ReferencePose, IsThatOfTheWorldWhereNothingSaysMore) {
  const std::vector<UndeformedBody> bodies = {{"a", 0.1, 2, {}}, {"b", 0, 0, {}}};
  const std::vector<ReferenceWeld> ring = {{{"a", {1, 0}, 0}, {"b", {0, 0}, 0}},
                                           {{"b", {1, 0}, 0}, {"a", {0, 0}, 0}}};
  const ReferencePose pose = reference_pose(bodies, ring, "a");
  EXPECT_EQ(pose.origin, Vec2(0, 0));
  EXPECT_EQ(pose.curvature, 2);
  EXPECT_THROW(reference_pose(bodies, ring, "c"), Error);
}

}  // namespace
}  // namespace flexmorph::fem
