// Shows that assembly, diagnosis and kinematics of rigid bodies in natural coordinates are right:
// closed-form motion of a four-bar, velocities after an impulse, and messages that name joints and
// not the unit axes of bodies.
#include <gtest/gtest.h>

#include <numbers>

#include "fem/body_joints.h"
#include "fem/elements/rigid_body.h"
#include "fem/rigid.h"
#include "fem/solve/assembly.h"
#include "fem/solve/kinematics.h"
#include "tests/support/differences.h"
#include "tests/support/point_mechanisms.h"

namespace flexmorph::fem {
namespace {

using testing::FourBar;
using testing::linear;
using Names = std::vector<std::string>;

/// Adds a rod that extends from its origin along its first axis, with its unit axis.
void add_rod(Workspace& model, const std::string& name, double length, double mass = 1) {
  const RigidSection section{mass, {length / 2, 0}, mass * length * length / 12};
  std::vector<std::unique_ptr<Term>> terms;
  terms.push_back(make_rigid_inertia(section));
  model.add_body(name, std::make_unique<RigidBody>(length / std::sqrt(12.0)), {}, std::move(terms));
  model.add_joint(make_unit_axis(name + " axis", name));
}

/// Sets origin and angle of a rigid body.
void location(const Model& model, const std::string& body, const Vec2& origin, double angle,
              VectorXd& q) {
  const int at = model.body(body).first_dof;
  q[at] = origin.x();
  q[at + 1] = origin.y();
  q[at + 2] = std::cos(angle);
  q[at + 3] = std::sin(angle);
}
double direction(const Vec2& from, const Vec2& to) {
  return std::atan2(to.y() - from.y(), to.x() - from.x());
}

struct RigidFourBar {
  FourBar bar;
  testing::Course angle;

  Workspace model() const {
    Workspace out;
    add_rod(out, "crank", bar.r);
    add_rod(out, "coupler", bar.l, 2);
    add_rod(out, "rocker", bar.s);
    out.add_joint(make_revolute("O", {}, {.body = "crank"}));
    out.add_joint(make_revolute("A", {"crank", {bar.r, 0}}, {.body = "coupler"}));
    out.add_joint(make_revolute("B", {"coupler", {bar.l, 0}}, {"rocker", {bar.s, 0}}));
    out.add_joint(make_revolute("C", {"", {bar.g, 0}}, {.body = "rocker"}));
    out.add_joint(make_angle_drive("motor", {}, {.body = "crank"}, angle));
    return out;
  }
  /// Returns all unknowns of the closed form with an angle error of `off`.
  VectorXd exact(const Model& model, double t, double off = 0) const {
    const double a = angle(t).value;
    const Vec2 pin = bar.crank_pin(a), end = bar.rocker_pin(a), ground(bar.g, 0);
    VectorXd q(model.n_dofs());
    location(model, "crank", {0, 0}, a + off, q);
    location(model, "coupler", pin, direction(pin, end) - off, q);
    location(model, "rocker", ground, direction(ground, end) + off, q);
    return q;
  }
};

// The start has angle errors of 0.2 rad; the motion covers a revolution and goes back.
TEST(RigidMechanisms, FourBarFollowsItsClosedForm) {
  const RigidFourBar mechanism{{}, linear(0.7, 2 * std::numbers::pi)};
  Workspace model = mechanism.model();
  State start = model.reference();
  start.q = mechanism.exact(model, 0, 0.2);
  EXPECT_TRUE(diagnose(model, start).is_independent());
  Kinematics motion(model, start);
  for (const double t : {0.0, 0.13, 0.5, 1.0, 1.21, -0.4}) {
    const State& x = motion.at(t);
    const auto near = [&](double s) { return mechanism.exact(model, t + s); };
    EXPECT_LT((x.q - near(0)).lpNorm<Eigen::Infinity>(), 1e-12) << t;
    EXPECT_LT((x.v - testing::first_difference(near, 1e-3)).lpNorm<Eigen::Infinity>(), 1e-7) << t;
    EXPECT_LT((x.a - testing::second_difference(near, 1e-3)).lpNorm<Eigen::Infinity>(), 1e-5) << t;
  }
}

TEST(RigidMechanisms, UnreachablePathNamesTimeAndJoints) {
  const FourBar bar{.r = 0.3, .l = 0.35, .s = 0.25, .g = 0.45};
  const RigidFourBar mechanism{bar, linear(0.5, 1.3)};
  Workspace model = mechanism.model();
  State start = model.reference();
  start.q = mechanism.exact(model, 0);
  Kinematics motion(model, start);
  try {
    motion.at(4);
    FAIL() << "the rods are too short";
  } catch (const Error& error) {
    const std::string text = error.what();
    EXPECT_NEAR(std::stod(text.substr(text.find("t = ") + 4)), (bar.limit_angle() - 0.5) / 1.3,
                1e-6);
    EXPECT_NE(text.find("'B'"), std::string::npos) << text;
    EXPECT_EQ(text.find("axis"), std::string::npos) << text;
  }
}

// The end of a rod at rest is suddenly moved across at speed w. The impulse p there satisfies p
// (1/m + s²/J) = w; the velocity of the centre is p/m and the angular velocity s p/J. Natural
// coordinates have the same kinetic energy, so that the smallest change in the mass norm is that
// motion. The masses are increased by 1e-8 of their mean 7.5 kg, which changes the determinant of
// the mass matrix of (r_y, u_y) by 1.2e-7 of itself and an angular velocity of 5 by less than 1e-6.
TEST(RigidMechanisms, VelocitiesAreThoseOfAnImpulse) {
  const double length = 0.6, mass = 3, s = length / 2, inertia = mass * length * length / 12;
  const double w = 2, impulse = w / (1 / mass + s * s / inertia);
  Workspace model;
  add_rod(model, "rod", length, mass);
  model.add_joint(make_point_drive("pull", {"rod", {length, 0}},
                                   [&](double t) {
                                     return std::vector<Motion>{{length, 0, 0}, {w * t, w, 0}};
                                   },
                                   {}));
  State x = model.reference();
  const Assembly report = assemble(model, x);
  EXPECT_LT(report.displacement, 1e-12);
  const double spin = s * impulse / inertia;
  EXPECT_NEAR(x.v[0], 0, 1e-12);
  EXPECT_NEAR(x.v[1], impulse / mass - spin * s, 1e-6);
  EXPECT_NEAR(x.v[2], 0, 1e-12);
  EXPECT_NEAR(x.v[3], spin, 1e-6);
}

TEST(RigidMechanisms, HingeAndWeldTwice) {
  const auto model_with = [](bool weld, double miss) {
    Workspace out;
    add_rod(out, "a", 1);
    add_rod(out, "b", 1);
    out.add_joint(make_revolute("ground", {}, {.body = "a"}));
    for (const int i : {0, 1}) {
      const std::string number = std::to_string(i + 1);
      // Hinges are at one point; welds are apart, which makes no difference for rigid bodies.
      const Vec2 on_a(1, weld ? 0.3 * i : 0), on_b(i * miss, weld ? 0.3 * i : 0);
      if (weld)
        out.add_joint(make_rigid_weld("weld_" + number, {"a", on_a}, {"b", on_b}));
      else
        out.add_joint(make_revolute("hinge_" + number, {"a", on_a}, {"b", on_b}));
    }
    return out;
  };
  const auto diagnosis_of = [](Workspace model) {
    State x = model.reference();
    location(model, "b", {1, 0}, 0, x.q);
    return diagnose(model, x);
  };
  const std::string hinged = describe(diagnosis_of(model_with(false, 0)));
  for (const char* part : {"'hinge_1'", "'hinge_2'", "2 degrees of freedom"})
    EXPECT_NE(hinged.find(part), std::string::npos) << hinged;
  const Diagnosis welded = diagnosis_of(model_with(true, 0));
  EXPECT_FALSE(welded.is_contradictory());
  for (const char* part : {"'weld_1'", "'weld_2'", "3 degrees of freedom"})
    EXPECT_NE(describe(welded).find(part), std::string::npos) << describe(welded);
  EXPECT_EQ(welded.degrees_of_freedom(), 1);
  const Diagnosis apart = diagnosis_of(model_with(true, 0.012));
  EXPECT_TRUE(apart.is_contradictory());
  ASSERT_EQ(apart.groups.size(), 1u) << describe(apart);
  EXPECT_EQ(apart.groups[0].joints, (Names{"weld_1", "weld_2"}));
}

// A platform on three equal, parallel links: each pair of them is independent, all three are
// redundant.
TEST(RigidMechanisms, ThreeParallelLinks) {
  const auto model_with = [](int links, double third) {
    Workspace out;
    add_rod(out, "platform", 1);
    for (int i = 0; i < links; ++i) {
      const std::string name = "link_" + std::to_string(i);
      const Vec2 foot(0.4 * i, i == 1 ? 0.2 : 0);
      add_rod(out, name, 0.5);
      out.add_joint(make_revolute(name + " foot", {"", foot}, {.body = name}));
      out.add_joint(
          make_revolute(name + " head", {name, {i == 2 ? third : 0.5, 0}}, {"platform", foot}));
    }
    return out;
  };
  const auto start = [](const Model& model, int links) {
    State x = model.reference();
    location(model, "platform", {0.3, 0.4}, 0, x.q);
    for (int i = 0; i < links; ++i)
      location(model, "link_" + std::to_string(i), {0.4 * i, i == 1 ? 0.2 : 0},
               std::atan2(0.4, 0.3), x.q);
    return x;
  };
  Workspace two = model_with(2, 0.5);
  const Diagnosis fine = diagnose(two, start(two, 2));
  EXPECT_TRUE(fine.is_independent());
  EXPECT_EQ(fine.degrees_of_freedom(), 1);

  Workspace three = model_with(3, 0.5);
  State x = start(three, 3);
  for (int i = 0; i < x.q.size(); ++i) x.q[i] += 0.05 * std::cos(3.0 * i);
  assemble(three, x);
  const Diagnosis d = diagnose(three, x);
  EXPECT_EQ(d.degrees_of_freedom(), 1);
  ASSERT_EQ(d.groups.size(), 1u) << describe(d);
  EXPECT_EQ(d.groups[0].surplus, 1);
  EXPECT_EQ(d.groups[0].joints, (Names{"link_0 foot", "link_0 head", "link_1 foot", "link_1 head",
                                       "link_2 foot", "link_2 head"}));
  EXPECT_FALSE(d.is_contradictory());
}

}  // namespace
}  // namespace flexmorph::fem
