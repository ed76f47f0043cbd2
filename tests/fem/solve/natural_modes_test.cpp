// Shows that natural modes are right: closed forms of beams and strips, of pendulums on springs, of
// a damped oscillator; published frequencies of a rotating beam; the number of rigid modes of
// mechanisms; and oscillations that the program itself integrates.
#include "fem/solve/natural_modes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fem/dynamics/motion.h"
#include "fem/dynamics/starts/start_parts.h"
#include "fem/elements/ancf_beam.h"
#include "fem/force_element.h"
#include "fem/loads.h"
#include "fem/solve/relaxation.h"
#include "fem/terms.h"
#include "tests/support/models.h"
#include "tests/support/rigid_models.h"

namespace flexmorph::fem {
namespace {

constexpr double kModulus = 2.1e11, kWidth = 0.01, kDensity = 7850;

PlaneSection section() { return {kWidth, kModulus, 0.0, kDensity}; }
/// Returns √(E I/(ρ A)) of a section of this height [m²/s].
double bending_unit(double height) { return std::sqrt(kModulus / (12 * kDensity)) * height; }

std::vector<std::unique_ptr<Term>> elastic(const std::string& term) {
  std::vector<std::unique_ptr<Term>> terms;
  terms.push_back(make_inertia(section()));
  terms.push_back(make_term(term, section()));
  return terms;
}

Workspace free_beam(double height, int n) {
  Workspace model;
  model.add_body("beam", std::make_unique<AncfBeam>(1, height, n), section(), elastic("ecm"));
  return model;
}

NaturalModes modes_at_rest(Workspace& model, const State& x, int count) {
  return natural_modes(model, x, std::vector<Turning>(model.bodies().size()), count);
}

double angular_frequency(const NaturalMode& mode) {
  return 2 * std::numbers::pi * mode.frequency();
}

// ω = β² √(E I/(ρ A)) with cos β cosh β = 1. Shear and rotary inertia reduce it by about 5e-5 at
// L/h = 200. Three rigid motions of equal frequency 0 must be found, each once.
TEST(NaturalModes, OfAFreeBeamAreThoseOfBernoulliAndEuler) {
  constexpr double kHeight = 1.0 / 200, beta[] = {4.7300407, 7.8532046, 10.9956078};
  for (const int n : {16, 100}) {  // dense matrices, and Lanczos' method
    Workspace model = free_beam(kHeight, n);
    const NaturalModes found = modes_at_rest(model, model.reference(), 6);
    ASSERT_EQ(found.modes.size(), 6u);
    EXPECT_EQ(found.n_rigid(), 3);
    EXPECT_EQ(found.degrees_of_freedom, model.n_dofs());
    EXPECT_FALSE(found.is_complex);
    for (size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(found.modes[k].frequency(), 0);
      const double exact = beta[k] * beta[k] * bending_unit(kHeight);
      EXPECT_NEAR(angular_frequency(found.modes[k + 3]) / exact, 1, n == 100 ? 1e-3 : 0.03) << k;
    }
  }
}

// The strip is a plate in the plane, cubic along its length and over its height.
TEST(NaturalModes, OfAClampedStripAreThoseOfBernoulliAndEuler) {
  constexpr double kHeight = 1.0 / 200, beta[] = {1.8751041, 4.6940911, 7.8547574};
  Workspace model;
  model.add_body(
      "strip",
      std::make_unique<AncfPlate>(2, AncfPlate::ShapeSet::h16, testing::uniform_lines(0, 1, 16),
                                  testing::uniform_lines(-kHeight / 2, kHeight / 2, 1)),
      section(), elastic("membrane_assumed"));
  model.add_joint(make_hold("clamp", "strip",
                            {{{.edge = "root"}, NodeVector::r, {0, 1}, {}},
                             {{.edge = "root"}, NodeVector::r_n, {0, 1}, {}}}));
  const NaturalModes found = modes_at_rest(model, model.reference(), 3);
  EXPECT_EQ(found.n_rigid(), 0);
  for (size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(angular_frequency(found.modes[k]) / (beta[k] * beta[k] * bending_unit(kHeight)), 1,
                1e-3)
        << k;
}

constexpr double kMass = 2, kInertia = 0.03, kArm = 0.25, kSpring = 40, kGravity = 9.81;

/// Returns a body on a pin at the origin with its centre of mass on its first axis.
Workspace pendulum(double gravity, double damping = 0) {
  VectorXd g;
  if (gravity != 0) g = Vec2(0, -gravity);
  Workspace model;
  testing::add_rigid(model, "bob", {kMass, {kArm, 0}, kInertia}, g);
  model.add_joint(make_revolute("pin", {"", {0, 0}}, {"bob", {0, 0}}));
  TorsionSpringData spring;
  spring.stiffness = kSpring;
  spring.damping = damping;
  spring.rest_angle = -std::numbers::pi / 2;
  model.add_force_element(make_torsion_spring("spring", {""}, {"bob"}, spring));
  return model;
}

/// Returns the state of the hanging pendulum with its multipliers.
State hanging(Workspace& model) {
  State x = model.reference();
  testing::put(model, "bob", {.angle = -std::numbers::pi / 2}, x);
  solve_static_equilibrium(model, x);
  return x;
}

// ω² = (k + m g l) / J about the pin: the weight enters through the force of the pin, which turns
// with nothing, in (Φ_qᵀ λ)_q.
TEST(NaturalModes, OfAPendulumOnASpringAreThoseOfItsMomentOfInertia) {
  const double J = kInertia + kMass * kArm * kArm;
  for (const double gravity : {0.0, kGravity}) {
    Workspace model = pendulum(gravity);
    const NaturalModes found = modes_at_rest(model, hanging(model), 5);
    ASSERT_EQ(found.modes.size(), 1u);
    EXPECT_EQ(found.degrees_of_freedom, 1);
    EXPECT_EQ(found.modes[0].kinetic_share, std::vector<double>{1.0});
    const double exact =
        std::sqrt((kSpring + kMass * testing::disturbed(VectorXd(Vec2(0, gravity)))[1] * kArm) / J);
    EXPECT_NEAR(angular_frequency(found.modes[0]) / exact, 1, 1e-9) << gravity;
  }
}

// J s² + c s + k = 0.
TEST(NaturalModes, OfADampedPendulumAreComplex) {
  const double J = kInertia + kMass * kArm * kArm, c = 0.7;
  Workspace model = pendulum(0, c);
  const NaturalModes found = modes_at_rest(model, hanging(model), 5);
  ASSERT_EQ(found.modes.size(), 1u);
  EXPECT_TRUE(found.is_complex);
  const double omega = std::sqrt(kSpring / J), ratio = c / (2 * std::sqrt(kSpring * J));
  EXPECT_NEAR(found.modes[0].damping_ratio(), ratio, 1e-9);
  EXPECT_NEAR(angular_frequency(found.modes[0]), omega * std::sqrt(1 - ratio * ratio),
              1e-9 * omega);
  EXPECT_FALSE(found.modes[0].grows());
}

// An upright pendulum falls: s = ± √((m g l - k) / J).
TEST(NaturalModes, OfAnUprightPendulumGrow) {
  Workspace model;
  testing::add_rigid(model, "bob", {kMass, {kArm, 0}, kInertia}, Vec2(0, -kGravity));
  model.add_joint(make_revolute("pin", {"", {0, 0}}, {"bob", {0, 0}}));
  State x = model.reference();
  testing::put(model, "bob", {.angle = std::numbers::pi / 2}, x);
  x.a.setZero();
  const NaturalModes found = [&] {
    State still = x;
    solve_static_equilibrium(model, still);
    return modes_at_rest(model, still, 5);
  }();
  ASSERT_EQ(found.modes.size(), 1u);
  EXPECT_TRUE(found.modes[0].grows());
  EXPECT_EQ(found.modes[0].frequency(), 0);
  const double J = kInertia + kMass * kArm * kArm;
  EXPECT_NEAR(std::abs(found.modes[0].eigenvalue), std::sqrt(kMass * kGravity * kArm / J), 1e-3);
}

// Newton's method may end at the upright pendulum; the relaxation cannot. A body that nothing holds
// falls, and the relaxation says so.
TEST(Relaxation, EndsAtTheHangingPendulum) {
  for (const double angle : {0.0, 1.4, 3.0}) {
    Workspace model = pendulum(kGravity);
    State x = model.reference();
    testing::put(model, "bob", {.angle = angle}, x);
    ASSERT_TRUE(relax_to_equilibrium(model, x)) << angle;
    // The spring is relaxed where the pendulum hangs.
    EXPECT_NEAR(testing::angle_of(model, "bob", x), -std::numbers::pi / 2, 1e-4) << angle;
  }
  Workspace model;
  testing::add_rigid(model, "stone", {kMass, {0, 0}, kInertia}, Vec2(0, -kGravity));
  State x = model.reference();
  EXPECT_FALSE(relax_to_equilibrium(model, x));
}

/// Returns a chain of links of length 0.3 on the ground; every link is 0.4 rad steeper.
Workspace chain(int links, int drives, State& x) {
  Workspace model;
  std::vector<testing::Pose> poses;
  Vec2 at(0, 0);
  for (int k = 0; k < links; ++k) {
    const std::string name = "link" + std::to_string(k),
                      last = k == 0 ? "" : "link" + std::to_string(k - 1);
    testing::add_rigid(model, name, {1.0 + k, {0.1, 0.02}, 0.01});
    model.add_joint(
        make_revolute("pin" + std::to_string(k), {last, {k == 0 ? 0 : 0.3, 0}}, {name, {0, 0}}));
    const double angle = 0.4 * (k + 1);
    if (k < drives)
      model.add_joint(make_angle_drive("drive" + std::to_string(k), {last}, {name}, [](double) {
        return Motion{0.4, 0, 0};
      }));
    poses.push_back({.r = at, .angle = angle});
    at += 0.3 * Vec2(std::cos(angle), std::sin(angle));
  }
  x = model.reference();
  for (int k = 0; k < links; ++k)
    testing::put(model, "link" + std::to_string(k), poses[static_cast<size_t>(k)], x);
  return model;
}

// Without gravity and springs nothing restores a mechanism: all its free modes are rigid.
TEST(NaturalModes, RigidOnesAreAsManyAsFreedomsWithoutDrives) {
  for (const int links : {1, 2, 4})
    for (int drives = 0; drives <= links; ++drives) {
      State x;
      Workspace model = chain(links, drives, x);
      const NaturalModes found = modes_at_rest(model, x, 20);
      EXPECT_EQ(found.degrees_of_freedom, links - drives);
      EXPECT_EQ(found.n_rigid(), links - drives) << links << " links, " << drives << " drives";
      EXPECT_EQ(found.modes.size(), static_cast<size_t>(links - drives));
    }
}

// Two free bodies with a spring and a damper between their centres: only their distance oscillates.
// Each of the five other motions has the eigenvalue 0 twice, and counts once.
TEST(NaturalModes, RigidOnesOfADampedPairAreFive) {
  constexpr double m1 = 2, m2 = 3, k = 500, c = 4;
  Workspace model;
  testing::add_rigid(model, "one", {m1, {0, 0}, 0.02});
  testing::add_rigid(model, "two", {m2, {0, 0}, 0.05});
  model.add_force_element(make_spring("spring", {"one"}, {"two"}, {k, c, 0.4}));
  State x = model.reference();
  testing::put(model, "two", {.r = {0.4, 0}, .angle = 0.3}, x);
  const NaturalModes found = modes_at_rest(model, x, 10);
  EXPECT_TRUE(found.is_complex);
  ASSERT_EQ(found.modes.size(), 6u);
  EXPECT_EQ(found.n_rigid(), 5);
  const double mass = m1 * m2 / (m1 + m2), ratio = c / (2 * std::sqrt(k * mass));
  EXPECT_NEAR(found.modes[5].damping_ratio(), ratio, 1e-7);
  EXPECT_NEAR(angular_frequency(found.modes[5]) / std::sqrt(k / mass * (1 - ratio * ratio)), 1,
              1e-7);
}

// A flexible beam between two free bodies: three rigid modes in the plane, then bending.
TEST(NaturalModes, RigidOnesOfAFreeBeamWithBodiesAreThree) {
  Workspace model = free_beam(0.02, 40);
  for (const auto& [name, edge] : {std::pair{"left", "root"}, std::pair{"right", "free_end"}}) {
    testing::add_rigid(model, name, {1, {0, 0}, 0.01});
    model.add_joint(make_edge_weld(std::string("weld ") + name, "beam", edge, {name, {0, 0}, 0, {}},
                                   WeldMode::partial));
  }
  State x = model.reference();
  testing::put(model, "right", {.r = {1, 0}}, x);
  const NaturalModes found = modes_at_rest(model, x, 5);
  ASSERT_EQ(found.modes.size(), 5u);
  EXPECT_EQ(found.n_rigid(), 3);
  EXPECT_GT(found.modes[3].frequency(), 1);
  double sum = 0;
  for (const double share : found.modes[3].kinetic_share) sum += share;
  EXPECT_NEAR(sum, 1, 1e-12);
}

// Uniform clamped beam that rotates about its root. Bending out of the plane of rotation, in units
// of √(E I/(ρ A)) / L²: Wright et al. (1982), J. Appl. Mech. 49, 197-202, table 1,
// for rates of 2, 4 and 8 in these units. Ritz's method with 14 polynomials has these numbers, too.
// In the plane of rotation ω² is lower by the square of the
// rate (spin softening).
TEST(NaturalModes, OfARotatingBeamAreThoseOfWright) {
  constexpr double kHeight = 1.0 / 400;
  const double unit = bending_unit(kHeight);
  struct Row {
    double rate, first, second;
  };
  for (const Row& row :
       {Row{2, 4.1373, 22.6149}, Row{4, 5.5850, 24.2733}, Row{8, 9.2568, 29.9954}}) {
    const double omega = row.rate * unit;
    Workspace model = free_beam(kHeight, 100);
    const FrameDrive hub = [omega](double t) {
      FrameMotion f;
      f.angle = 0.3 + omega * t;
      f.angle_rate = omega;
      return f;
    };
    model.add_joint(make_weld("hub", "beam", "root", hub, WeldMode::partial));
    const BodyPoses poses = [hub](double t) { return std::vector<BodyPose>{{"beam", hub(t), 0}}; };
    const start::SteadyEquilibrium at = start::steady_equilibrium(model, {}, poses, 0.1);
    const NaturalModes found = natural_modes(model, at.strained, at.turning, 2);
    EXPECT_TRUE(found.is_complex);
    for (size_t k = 0; k < 2; ++k) {
      const double flap = k == 0 ? row.first : row.second,
                   lag = std::sqrt(flap * flap - row.rate * row.rate);
      EXPECT_NEAR(angular_frequency(found.modes[k]) / unit / lag, 1, 1e-3) << row.rate << ' ' << k;
      EXPECT_NEAR(found.modes[k].damping_ratio(), 0, 1e-6);
    }
  }
}

/// Returns the frequency of an oscillation from its first and last zero of rising sign [Hz].
double frequency_of_crossings(const std::vector<double>& t, const std::vector<double>& y) {
  double first = 0, last = 0;
  int periods = -1;
  for (size_t k = 1; k < t.size(); ++k) {
    if (!(y[k - 1] < 0 && y[k] >= 0)) continue;
    last = t[k] - (t[k] - t[k - 1]) * y[k] / (y[k] - y[k - 1]);
    if (periods++ < 0) first = last;
  }
  return periods / (last - first);
}

// A flexible arm on a body that turns on a pin with a spring, under gravity: after a small push in
// the shape of a mode the program's own motion has its frequency over 20 periods.
TEST(NaturalModes, AreFrequenciesOfTheMotionAfterASmallPush) {
  constexpr double kHeight = 0.02;
  Workspace model = pendulum(kGravity);
  std::vector<std::unique_ptr<Term>> terms = elastic("ecm");
  terms.push_back(make_gravity(section(), LoadLaw(VectorXd(Vec2(0, -kGravity)))));
  model.add_body("arm", std::make_unique<AncfBeam>(1, kHeight, 8), section(), std::move(terms));
  model.add_joint(make_edge_weld("weld", "arm", "root",
                                 {"bob", {kArm, 0}, std::numbers::pi / 2, {}}, WeldMode::partial));
  State x = model.reference();
  testing::put(model, "bob", {.angle = -std::numbers::pi / 2}, x);
  {
    VectorXd q = x.q.segment(model.body("arm").first_dof, model.body("arm").n_dofs());
    for (int at = 0; at < q.size(); at += 6) q[at + 1] -= kArm;  // positions; slopes stay
    x.q.segment(model.body("arm").first_dof, q.size()) = q;
  }
  solve_static_equilibrium(model, x);
  const NaturalModes found = modes_at_rest(model, x, 2);
  ASSERT_EQ(found.modes.size(), 2u);
  for (const NaturalMode& mode : found.modes) {
    const double period = 1 / mode.frequency();
    State pushed = x;
    const VectorXd shape = mode.shape.real();
    pushed.v = 1e-4 * angular_frequency(mode) * shape;
    std::unique_ptr<Integrator> integrator = make_integrator(model, {.name = "generalized_alpha",
                                                                     .alpha = {},
                                                                     .energy_momentum = {},
                                                                     .minimal_coordinates = {}});
    integrator->project_velocity(pushed);
    integrator->make_consistent(pushed);
    integrator->begin_motion(pushed, period / 60);
    std::vector<double> t, y;
    for (int step = 1; step <= 20 * 60 + 10; ++step)
      integrator->advance(pushed, step * period / 60, [&](const State& s) {
        t.push_back(s.t);
        y.push_back(shape.dot(s.q - x.q));
      });
    EXPECT_NEAR(frequency_of_crossings(t, y) / mode.frequency(), 1, 0.01);
  }
}

}  // namespace
}  // namespace flexmorph::fem
