// Shows that motions of closed loops stay on their branch at any time step, and that redundant
// joints move as the geometry says: a crank-rocker against Freudenstein's equation, coupled wheels,
// a trammel and Peaucellier's linkage.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fem/body_joints.h"
#include "fem/dynamics/motion.h"
#include "fem/dynamics/starts/rigid_motion.h"
#include "fem/solve/redundancy.h"
#include "geometry/text.h"
#include "tests/support/errors.h"
#include "tests/support/point_mechanisms.h"

namespace flexmorph::fem {
namespace {

using testing::Course;
using testing::error_of;
using testing::linear;
using testing::mentions;

Vec2 polar(double length, double angle) { return length * Vec2(std::cos(angle), std::sin(angle)); }
double direction(const Vec2& from, const Vec2& to) {
  return std::atan2(to.y() - from.y(), to.x() - from.x());
}

/// A mechanism of slender rods, which extend from their origins along their first axes.
struct Rods {
  RigidMechanism all;

  void rod(const std::string& name, double length, const Vec2& at, double angle) {
    MechanismBody body;
    body.name = name;
    body.section = {1, {length / 2, 0}, length * length / 12};
    body.size = length / std::sqrt(12.0);
    body.position = at;
    body.angle = angle;
    all.bodies.push_back(body);
  }
  void pin(const std::string& name, const std::string& a, const Vec2& at_a, const std::string& b,
           const Vec2& at_b = {0, 0}) {
    all.joints.push_back({.joint = make_revolute(name, {a, at_a}, {b, at_b})});
  }
  void slot(const std::string& name, double angle, const std::string& b) {
    all.joints.push_back({.joint = make_slider(name, {"", {0, 0}, angle, {}}, {b})});
  }
  void motor(const std::string& body, const Course& angle) {
    all.joints.push_back({.joint = make_angle_drive("motor", {}, {body}, angle),
                          .is_driven = true,
                          .prescribes = true});
  }

  using See = std::function<void(const MotionStep&)>;
  MotionResult move(double end, double step, const std::string& integrator, const See& see) const {
    const RigidKinematics kinematics(all);
    Workspace model;
    for (const MechanismBody& body : all.bodies) add_rigid_body(model, body, all.gravity);
    for (const MechanismJoint& joint : all.joints) model.add_joint(joint.joint->clone());
    MotionSettings settings;
    settings.end = end;
    settings.step = step;
    settings.integrator = integrator;
    settings.start = Start::rigid;
    settings.body_poses = rigid_configuration(kinematics);
    return integrate(model, {}, settings, see);
  }
};

double angle_of(const MotionStep& step, const std::string& body) {
  const int at = step.model.body(body).first_dof;
  return std::atan2(step.x.q[at + 3], step.x.q[at + 2]);
}
Vec2 origin_of(const MotionStep& step, const std::string& body) {
  return step.x.q.segment<2>(step.model.body(body).first_dof);
}
double difference(double a, double b) {
  return std::abs(std::remainder(a - b, 2 * std::numbers::pi));
}

/// Returns the angle of the rocker of the crank-rocker with links of 1 (ground), 0.5, 1.2 and 0.8 m
/// on its open branch, from Freudenstein's equation k₁ cos ψ - k₂ cos φ + k₃ = cos (φ - ψ).
double rocker_angle(double crank) {
  const double d = 1, a = 0.5, b = 1.2, c = 0.8;
  const double k1 = d / a, k2 = d / c, k3 = (a * a - b * b + c * c + d * d) / (2 * a * c);
  // With u = tan (ψ / 2) it is A u² + B u + C = 0.
  const double A = std::cos(crank) - k1 - k2 * std::cos(crank) + k3, B = -2 * std::sin(crank),
               C = k1 - (k2 + 1) * std::cos(crank) + k3;
  return 2 * std::atan2(-B - std::sqrt(B * B - 4 * A * C), 2 * A);
}

Rods crank_rocker(double coupler, double rocker, const Course& angle) {
  Rods out;
  out.rod("crank", 0.5, {0, 0}, 0);
  out.rod("coupler", 1.2, {0.5, 0}, coupler);
  out.rod("rocker", 0.8, {1, 0}, rocker);
  out.pin("A0", "", {0, 0}, "crank");
  out.motor("crank", angle);
  out.pin("A", "crank", {0.5, 0}, "coupler");
  out.pin("B", "coupler", {1.2, 0}, "rocker", {0.8, 0});
  out.pin("B0", "", {1, 0}, "rocker");
  return out;
}

struct StepCase {
  double step;
  std::string integrator;
};

class CrankRocker : public ::testing::TestWithParam<StepCase> {};

TEST_P(CrankRocker, StaysOnItsBranch) {
  const auto& [step, integrator] = GetParam();
  double error = 0, smallest = 10, largest = 0, last = 0;
  crank_rocker(0.5053609157141864, 0.8127561994224595, linear(0, 2 * std::numbers::pi))
      .move(1, step, integrator, [&](const MotionStep& s) {
        const double angle = angle_of(s, "rocker");
        error = std::max(error, difference(angle, rocker_angle(2 * std::numbers::pi * s.x.t)));
        smallest = std::min(smallest, angle);
        largest = std::max(largest, angle);
        last = s.x.t;
        if (std::abs(s.x.t - 0.75) < 1e-9) {
          EXPECT_NEAR(angle * 180 / std::numbers::pi, 131.1348, 1e-4);
        }
      });
  EXPECT_EQ(last, 1);
  EXPECT_LT(error, 1e-9);
  EXPECT_GT(smallest * 180 / std::numbers::pi, 38.6247);
  EXPECT_LT(largest * 180 / std::numbers::pi, 135.9515);
}
INSTANTIATE_TEST_SUITE_P(
    Steps, CrankRocker,
    ::testing::Values(StepCase{1e-3, "generalized_alpha"}, StepCase{0.05, "generalized_alpha"},
                      StepCase{0.1, "generalized_alpha"}, StepCase{0.2, "generalized_alpha"},
                      StepCase{0.1, "energy_momentum"}, StepCase{0.2, "energy_momentum"},
                      StepCase{0.2, "minimal_coordinates"}),
    [](const auto& test) {
      return test.param.integrator + formatted("_%.0f_ms", 1e3 * test.param.step);
    });

// A parallelogram whose crank is 1e-4 m too short turns over where its branches almost meet. The
// rocker changes its direction there within milliseconds, whatever the step is.
TEST(ClosedLoops, BranchesThatAlmostMeetAreDistinguished) {
  const testing::FourBar bar{.r = 0.2999, .l = 0.5, .s = 0.3, .g = 0.5};
  const Course angle = linear(0.8, 2 * std::numbers::pi);
  for (const char* integrator : {"generalized_alpha", "minimal_coordinates"})
    for (const double step : {1e-3, 0.05, 0.1}) {
      const Vec2 a = bar.crank_pin(0.8), b = bar.rocker_pin(0.8), c(bar.g, 0);
      Rods rods;
      rods.rod("crank", bar.r, {0, 0}, 0.8);
      rods.rod("coupler", bar.l, a, direction(a, b));
      rods.rod("rocker", bar.s, c, direction(c, b));
      rods.pin("A0", "", {0, 0}, "crank");
      rods.pin("A", "crank", {bar.r, 0}, "coupler");
      rods.pin("B", "coupler", {bar.l, 0}, "rocker", {bar.s, 0});
      rods.pin("B0", "", c, "rocker");
      rods.motor("crank", angle);
      double error = 0;
      rods.move(1, step, integrator, [&](const MotionStep& s) {
        const Vec2 exact = bar.rocker_pin(angle(s.x.t).value) - c;
        error =
            std::max(error, difference(angle_of(s, "rocker"), std::atan2(exact.y(), exact.x())));
      });
      EXPECT_LT(error, 1e-8) << integrator << " " << step;
    }
}

// Where a parallelogram is flat, drives alone do not determine how it continues.
TEST(ClosedLoops, EndWhereBranchesMeet) {
  for (const char* integrator : {"generalized_alpha", "minimal_coordinates"}) {
    Rods rods;
    rods.rod("crank", 0.3, {0, 0}, 0.8);
    rods.rod("coupler", 0.5, polar(0.3, 0.8), 0);
    rods.rod("rocker", 0.3, {0.5, 0}, 0.8);
    rods.pin("A0", "", {0, 0}, "crank");
    rods.pin("A", "crank", {0.3, 0}, "coupler");
    rods.pin("B", "coupler", {0.5, 0}, "rocker", {0.3, 0});
    rods.pin("B0", "", {0.5, 0}, "rocker");
    rods.motor("crank", linear(0.8, -1));
    double last = 0;
    const std::string text = error_of(Error::Kind::numerical, [&] {
      rods.move(2, 0.013, integrator, [&](const MotionStep& s) { last = s.x.t; });
    });
    EXPECT_NEAR(last, 0.8, 0.014) << integrator;
    EXPECT_TRUE(mentions(text, "t = 0.7") || mentions(text, "t = 0.8")) << text;
    EXPECT_TRUE(mentions(text, "'B'")) << text;
  }
}

/// Wheels (cranks) at distances of 1 m that rods couple at equal angles from the cranks. The last
/// pin of a rod has an error.
Rods coupled_wheels(int wheels, const std::vector<double>& rods, double error = 0,
                    double start = 0.5) {
  Rods out;
  const auto crank = [](int k) { return "crank" + std::to_string(k); };
  for (int k = 0; k < wheels; ++k) {
    out.rod(crank(k), 0.2, {k * 1.0, 0}, start);
    out.pin("axle" + std::to_string(k), "", {k * 1.0, 0}, crank(k));
  }
  for (size_t i = 0; i < rods.size(); ++i) {
    const std::string rod = "rod" + std::to_string(i);
    out.rod(rod, wheels - 1.0, polar(0.2, start + rods[i]), 0);
    for (int k = 0; k < wheels; ++k)
      out.pin("pin" + std::to_string(i) + std::to_string(k), crank(k), polar(0.2, rods[i]), rod,
              {k * 1.0 + (k == wheels - 1 ? error : 0), 0});
  }
  out.motor("crank0", linear(start, std::numbers::pi));
  return out;
}

struct Wheels {
  int number;
  std::vector<double> rods;
  double step;
  std::string integrator;
};

class CoupledWheels : public ::testing::TestWithParam<Wheels> {};

// At the dead centres of one rod, the third wheel or the second rod determines the branch.
TEST_P(CoupledWheels, TurnTogether) {
  const auto& [number, rods, step, integrator] = GetParam();
  double error = 0, last = 0;
  const MotionResult result =
      coupled_wheels(number, rods).move(2, step, integrator, [&, n = number](const MotionStep& s) {
        last = s.x.t;
        for (int k = 0; k < n; ++k)
          error = std::max(error, difference(angle_of(s, "crank" + std::to_string(k)),
                                             0.5 + std::numbers::pi * s.x.t));
      });
  EXPECT_EQ(last, 2);
  EXPECT_LT(error, 1e-9);
  const auto& names = result.redundant_joints;
  for (const char* name : {"pin00", "pin01", "axle1"})
    EXPECT_EQ(std::count(names.begin(), names.end(), name), 1) << name;
}
INSTANTIATE_TEST_SUITE_P(
    Sets, CoupledWheels,
    ::testing::Values(Wheels{3, {0.0}, 1e-2, "generalized_alpha"},
                      Wheels{3, {0.0}, 1e-3, "generalized_alpha"},
                      Wheels{3, {0.0}, 1e-2, "energy_momentum"},
                      Wheels{3, {0.0}, 1e-2, "minimal_coordinates"},
                      Wheels{2, {0.0, std::numbers::pi / 2}, 1e-2, "generalized_alpha"},
                      Wheels{2, {0.0, std::numbers::pi / 2}, 1e-2, "minimal_coordinates"}),
    [](const auto& test) {
      return formatted("%d_wheels_%.0f_ms_", test.param.number, 1e3 * test.param.step) +
             test.param.integrator;
    });

// The motion is tried from several angles. From a right angle, a step ends exactly at a dead
// centre.
TEST(ClosedLoops, CoupledWheelsPassDeadCentresAtAnyTime) {
  for (const char* integrator : {"generalized_alpha", "minimal_coordinates"})
    for (const double start : {std::numbers::pi / 2, 0.7, 1.1, 1.3, 2.0, 2.9, 3.1}) {
      if (start == std::numbers::pi / 2 && integrator != std::string("generalized_alpha")) continue;
      double error = 0;
      coupled_wheels(3, {0.0}, 0, start).move(1, 0.01, integrator, [&](const MotionStep& s) {
        for (const char* crank : {"crank1", "crank2"})
          error = std::max(error, difference(angle_of(s, crank), start + std::numbers::pi * s.x.t));
      });
      EXPECT_LT(error, 1e-9) << integrator << " from " << start;
    }
}

// The last pin does not fit, and it is named first.
TEST(ClosedLoops, RedundantJointsThatContradictAreRefused) {
  const std::string text = error_of(
      Error::Kind::input, [] { RigidMotion(RigidKinematics(coupled_wheels(3, {0.0}, 1e-3).all)); });
  EXPECT_TRUE(mentions(text, "contradict")) << text;
  const size_t first = text.find('\'');
  EXPECT_TRUE(text.substr(first, 7) == "'pin02'" || text.substr(first, 7) == "'motor'") << text;
}

// A rod of length 2 L with its ends on the axes and its middle on a crank of length L: one of the
// three is redundant, and each is at a dead centre where the others determine the rod. The origin
// of the rod, at distances a and b from the ends, moves on an ellipse with these half axes.
TEST(ClosedLoops, TrammelDrawsAnEllipse) {
  const double L = 0.4, a = 0.5, b = 0.3, start = 0.3;
  Rods rods;
  rods.rod("crank", L, {0, 0}, start);
  rods.rod("rod", 0.1, {a * std::cos(start), b * std::sin(start)}, -start);
  rods.rod("block_x", 0.1, {2 * L * std::cos(start), 0}, 0);
  rods.rod("block_y", 0.1, {0, 2 * L * std::sin(start)}, std::numbers::pi / 2);
  rods.pin("axle", "", {0, 0}, "crank");
  rods.pin("middle", "crank", {L, 0}, "rod", {b - L, 0});
  rods.slot("slot_x", 0, "block_x");
  rods.slot("slot_y", std::numbers::pi / 2, "block_y");
  rods.pin("end_x", "block_x", {0, 0}, "rod", {b, 0});
  rods.pin("end_y", "block_y", {0, 0}, "rod", {-a, 0});
  rods.motor("crank", linear(start, std::numbers::pi));
  for (const char* integrator : {"generalized_alpha", "minimal_coordinates"}) {
    double error = 0;
    rods.move(2, 1e-2, integrator, [&](const MotionStep& s) {
      const double angle = start + std::numbers::pi * s.x.t;
      const Vec2 exact(a * std::cos(angle), b * std::sin(angle));
      error = std::max(error, (origin_of(s, "rod") - exact).norm());
    });
    EXPECT_LT(error, 1e-9) << integrator;
  }
}

// The crank QC moves C on a circle through O. D, the opposite corner of the rhombus ACBD, moves on
// the line x = (L² - l²) / 2r. Two equal rods connect A and C; each carries half of the force.
TEST(ClosedLoops, PeaucellierDrawsALineWithASpareRod) {
  const double L = 0.8, l = 0.3, r = 0.35, start = -0.8;
  const Vec2 q(r, 0), c = q + polar(r, start), e = c.normalized(), n(-e.y(), e.x());
  const double half = (c.norm() + (L * L - l * l) / c.norm()) / 2,
               height = std::sqrt(L * L - half * half);
  const Vec2 a = half * e + height * n, b = half * e - height * n,
             d = (L * L - l * l) / c.norm() * e;
  Rods rods;
  rods.rod("crank", r, q, start);
  rods.rod("OA", L, {0, 0}, direction({0, 0}, a));
  rods.rod("OB", L, {0, 0}, direction({0, 0}, b));
  rods.rod("CA", l, c, direction(c, a));
  rods.rod("CB", l, c, direction(c, b));
  rods.rod("DA", l, d, direction(d, a));
  rods.rod("DB", l, d, direction(d, b));
  rods.rod("spare", l, c, direction(c, a));
  rods.pin("Q", "", q, "crank");
  rods.pin("O_A", "", {0, 0}, "OA");
  rods.pin("O_B", "", {0, 0}, "OB");
  rods.pin("C_A", "crank", {r, 0}, "CA");
  rods.pin("C_B", "crank", {r, 0}, "CB");
  rods.pin("A_C", "OA", {L, 0}, "CA", {l, 0});
  rods.pin("A_D", "OA", {L, 0}, "DA", {l, 0});
  rods.pin("B_C", "OB", {L, 0}, "CB", {l, 0});
  rods.pin("B_D", "OB", {L, 0}, "DB", {l, 0});
  rods.pin("D_AB", "DA", {0, 0}, "DB");
  rods.pin("spare_C", "crank", {r, 0}, "spare");
  rods.pin("spare_A", "OA", {L, 0}, "spare", {l, 0});
  rods.motor("crank", [](double t) {
    const double w = 2 * std::numbers::pi;
    return Motion{-0.8 * std::cos(w * t), 0.8 * w * std::sin(w * t), 0.8 * w * w * std::cos(w * t)};
  });
  double error = 0, low = 0, high = 0, force = 0, unequal = 0;
  const MotionResult result = rods.move(1, 1e-2, "generalized_alpha", [&](const MotionStep& s) {
    const Vec2 at = origin_of(s, "DA");
    error = std::max(error, std::abs(at.x() - (L * L - l * l) / (2 * r)));
    low = std::min(low, at.y());
    high = std::max(high, at.y());
    const auto row_of = [&](const std::string& name) {
      const auto& joints = s.model.joints();
      size_t k = 0;
      while (joints[k]->name() != name) ++k;
      return s.model.first_row(k);
    };
    const Vec2 rod = s.x.lambda.segment<2>(row_of("C_A")),
               spare = s.x.lambda.segment<2>(row_of("spare_C"));
    force = std::max(force, rod.norm());
    unequal = std::max(unequal, (rod - spare).norm());
  });
  EXPECT_LT(error, 1e-9);
  EXPECT_GT(high - low, 0.6);
  EXPECT_GT(force, 1);
  EXPECT_LT(unequal, 1e-6 * force);
  EXPECT_EQ(result.redundant_joints,
            (std::vector<std::string>{"C_A", "A_C", "spare_C", "spare_A"}));
}

// All rods lie on one line, from which no correction leads away. Of the two positions that other
// starts find, the one with the rods turned counterclockwise is taken.
TEST(OtherStarts, FindThePositionOfAFlatCrankRocker) {
  const RigidKinematics flat(crank_rocker(0, 0, linear(0, 2 * std::numbers::pi)).all);
  RigidMotion motion(flat);
  EXPECT_TRUE(mentions(motion.kinematics().remark(), "'rocker'")) << motion.kinematics().remark();
  EXPECT_NEAR(motion.kinematics().frame("coupler", motion.at(0)).angle,
              std::atan2(0.8 * std::sin(rocker_angle(0)), 0.5 + 0.8 * std::cos(rocker_angle(0))),
              1e-10);
  EXPECT_LT(difference(motion.kinematics().frame("rocker", motion.at(0)).angle, rocker_angle(0)),
            1e-10);
  EXPECT_EQ(undriven_degrees_of_freedom(flat), 1);
  const RigidKinematics near(crank_rocker(0.5, 0.8, linear(0, 2 * std::numbers::pi)).all);
  EXPECT_TRUE(RigidMotion(near).kinematics().remark().empty());
}

}  // namespace
}  // namespace flexmorph::fem
