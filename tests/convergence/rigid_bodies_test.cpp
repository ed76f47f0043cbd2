// Shows that rigid bodies in natural coordinates move correctly: a physical pendulum agrees with
// elliptic functions, a slider-crank with its closed-form kinematics and the power of its drive,
// springs and dampers with their oscillators, all with order 2 of generalized-alpha in positions,
// velocities and multipliers; the energy-momentum scheme conserves energy.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <iostream>
#include <numbers>

#include "fem/dynamics/integrators/energy_momentum.h"
#include "fem/dynamics/integrators/generalized_alpha.h"
#include "fem/dynamics/motion.h"
#include "tests/support/differences.h"
#include "tests/support/rates.h"
#include "tests/support/rigid_models.h"

namespace flexmorph::fem {
namespace {

constexpr double kGravity = 9.81;

/// Errors at the end of a run; lambda: of multipliers or forces.
struct Errors {
  double q = 0, v = 0, lambda = 0;
};
using Run = std::function<Errors(double h)>;

void expect_order_two(const std::string& what, const std::vector<double>& steps, const Run& run) {
  for (const auto& [name, value] :
       {std::pair{"q", &Errors::q}, {"v", &Errors::v}, {"lambda", &Errors::lambda}}) {
    const auto rate = testing::fit_rate(steps, [&](double h) { return run(h).*value; });
    std::cout << what << ": " << name << '\n' << rate.table();
    EXPECT_NEAR(rate.order(), 2, 0.1) << what << ' ' << name << '\n' << rate.table();
  }
}

/// Advances from t = 0 to the end in steps of about h.
void advance(Workspace& model, State& x, double end, double h) {
  AlphaSettings settings;
  settings.tolerance = 1e-14;
  GeneralizedAlpha alpha(model, settings);
  alpha.make_consistent(x);
  const int n = static_cast<int>(std::lround(end / h));
  for (int k = 1; k <= n; ++k) alpha.advance(x, end * k / n, [](const State&) {});
}

/// A body whose hinge, centre of mass and point r are three different points, released at an angle
/// from below.
struct PhysicalPendulum {
  RigidSection section{3, {0.4, -0.1}, 0.2};
  Vec2 hinge{-0.3, 0.2};
  double amplitude = 2;

  double length() const { return (section.center - hinge).norm(); }
  double inertia() const { return section.inertia + section.mass * length() * length(); }
  double weight_moment() const { return section.mass * kGravity * length(); }
  /// Returns T = 4 √(I / m g l) K(sin(θ₀/2)).
  double period() const {
    return 4 * std::sqrt(inertia() / weight_moment()) * std::comp_ellint_1(std::sin(amplitude / 2));
  }
  /// Returns the angle of the body's axis when the line from hinge to centre has the given angle to
  /// the vertical.
  double axis(double swing) const {
    const Vec2 line = section.center - hinge;
    return swing - std::numbers::pi / 2 - std::atan2(line.y(), line.x());
  }
  Workspace model() const {
    Workspace out;
    testing::add_rigid(out, "body", section, Vec2(0, -kGravity));
    out.add_joint(make_revolute("hinge", {}, {.body = "body", .point = hinge}));
    return out;
  }
  State start(const Model& model) const {
    State x = model.reference();
    const double angle = axis(amplitude);
    testing::put(model, "body", {-(Eigen::Rotation2Dd(angle) * hinge), angle}, x);
    return x;
  }
};

// After 5/4 periods the pendulum passes the lowest point: ω² = 2 m g l (1 - cos θ₀) / I, and the
// force of the hinge is m g + m l ω².
TEST(PhysicalPendulum, ConvergesToEllipticFunctions) {
  const PhysicalPendulum p;
  const double end = 1.25 * p.period();
  const double rate = -std::sqrt(2 * p.weight_moment() * (1 - std::cos(p.amplitude)) / p.inertia());
  const Vec2 reaction(0, p.section.mass * (kGravity + p.length() * rate * rate));
  expect_order_two("pendulum", {end / 400, end / 800, end / 1600}, [&](double h) {
    Workspace model = p.model();
    State x = p.start(model);
    advance(model, x, end, h);
    return Errors{
        std::abs(
            std::remainder(testing::angle_of(model, "body", x) - p.axis(0), 2 * std::numbers::pi)),
        std::abs(testing::angle_rate_of(model, "body", x) - rate),
        (Vec2(model.joint_wrench(1, "body", Vec3::Zero(), x).force.head<2>()) - reaction).norm()};
  });
}

// Φ is of degree 2, forces are linear, and the spring has a discrete gradient; therefore energy is
// conserved to the accuracy of Newton's method.
TEST(PhysicalPendulum, KeepsItsEnergyInTheEnergyMomentumScheme) {
  const PhysicalPendulum p;
  for (const bool spring : {false, true}) {
    Workspace model = p.model();
    if (spring)
      model.add_force_element(make_spring("spring", {.point = {1, 0.5}},
                                          {.body = "body", .point = {0.4, 0.1}}, {60, 0, 0.4}));
    State x = p.start(model);
    EnergyMomentum scheme(model, {});
    scheme.make_consistent(x);
    const double start = model.energies(x).total();
    double worst = 0, kinetic = 0;
    for (int k = 1; k <= 300; ++k)
      scheme.advance(x, 0.02 * k, [&](const State& y) {
        const Energies e = model.energies(y);
        worst = std::max(worst, std::abs(e.total() - start));
        kinetic = std::max(kinetic, e.kinetic);
      });
    std::cout << "energy error " << worst << " J of " << kinetic << " J kinetic\n";
    EXPECT_GT(kinetic, 10);
    EXPECT_LT(worst, 1e-11 * kinetic);
  }
}

// A motor acts against a damper and a spring with an oscillating end, and all energy is counted:
// the energy error is that of the trapezoidal rule over the powers and of the scheme.
TEST(EnergyBalance, CountsDampersAndMotors) {
  const auto energy_error = [](double h) {
    Workspace model;
    testing::add_rigid(model, "rotor", {3, {0.4, -0.1}, 0.2}, Vec2(0, -kGravity));
    model.add_joint(make_revolute("axis", {}, {.body = "rotor"}));
    model.add_force_element(make_torque("motor", {.body = "rotor"}, 8));
    model.add_force_element(make_torsion_spring("brake", {}, {.body = "rotor"}, {0, 0.7, 0}));
    const auto shaken = [](double t) {
      return Motion{0.1 * std::sin(9 * t), 0.9 * std::cos(9 * t), -8.1 * std::sin(9 * t)};
    };
    model.add_force_element(make_spring("spring", {.point = {1, 0.3}, .along = shaken},
                                        {.body = "rotor", .point = {0.2, 0.2}}, {40, 2, 0.3}));
    MotionSettings settings;
    settings.end = 2;
    settings.step = h;
    settings.start = Start::rigid;
    double work = 0;
    const MotionResult result = integrate(
        model, {}, settings, [&](const MotionStep& s) { work = std::max(work, std::abs(s.work)); });
    EXPECT_GT(work, 1);
    return result.energy_error;
  };
  const auto rate = testing::fit_rate({4e-3, 2e-3, 1e-3}, energy_error);
  std::cout << "defect of the energy balance\n" << rate.table();
  EXPECT_NEAR(rate.order(), 2, 0.2) << rate.table();
  EXPECT_LT(rate.error.back(), 1e-4) << rate.table();
}

/// A crank with growing speed, its rod, and a block that slides on a line offset from the crank's
/// axis.
struct SliderCrank {
  double crank = 0.15, rod = 0.4, offset = 0.03;
  RigidSection crank_section{1.2, {0.06, 0.01}, 0.004}, rod_section{0.8, {0.21, -0.02}, 0.011},
      block_section{0.5, {0, 0}, 0.001};

  static Motion drive(double t) { return {0.4 + 3 * t + 2 * t * t, 3 + 4 * t, 4}; }
  double rod_angle(double t) const {
    return std::asin((offset - crank * std::sin(drive(t).value)) / rod);
  }
  /// Returns the points r of rod and block, and the angle of the rod (5).
  Eigen::Vector<double, 5> kinematics(double t) const {
    const double a = drive(t).value, b = rod_angle(t);
    return {crank * std::cos(a), crank * std::sin(a), crank * std::cos(a) + rod * std::cos(b),
            offset, b};
  }
  /// Returns the total energy of the mechanism in the closed form.
  double energy(double t) const {
    const auto at = [&](double dt) { return kinematics(t + dt); };
    const Eigen::Vector<double, 5> x = at(0), rate = testing::first_difference(at, 1e-3);
    const auto of = [](const RigidSection& s, const Vec2& r, double angle, const Vec2& r_t,
                       double angle_t) {
      const Vec2 arm = Eigen::Rotation2Dd(angle) * s.center;
      const Vec2 velocity = r_t + angle_t * Vec2(-arm.y(), arm.x());
      return 0.5 * s.mass * velocity.squaredNorm() + 0.5 * s.inertia * angle_t * angle_t +
             s.mass * kGravity * (r + arm).y();
    };
    return of(crank_section, {0, 0}, drive(t).value, {0, 0}, drive(t).rate) +
           of(rod_section, x.head<2>(), x[4], rate.head<2>(), rate[4]) +
           of(block_section, x.segment<2>(2), 0, rate.segment<2>(2), 0);
  }

  Workspace model() const {
    Workspace out;
    const Vec2 gravity(0, -kGravity);
    testing::add_rigid(out, "crank", crank_section, gravity);
    testing::add_rigid(out, "rod", rod_section, gravity);
    testing::add_rigid(out, "block", block_section, gravity);
    out.add_joint(make_revolute("axis", {}, {.body = "crank"}));
    out.add_joint(
        make_revolute("crank pin", {.body = "crank", .point = {crank, 0}}, {.body = "rod"}));
    out.add_joint(
        make_revolute("wrist pin", {.body = "rod", .point = {rod, 0}}, {.body = "block"}));
    out.add_joint(make_slider("guide", {.point = {0, offset}}, {.body = "block"}));
    out.add_joint(make_angle_drive("drive", {}, {.body = "crank"}, drive));
    return out;
  }
  State at(const Model& model, double t) const {
    const auto x = [&](double dt) { return kinematics(t + dt); };
    const Eigen::Vector<double, 5> now = x(0), rate = testing::first_difference(x, 1e-3);
    State out = model.reference();
    const Motion a = drive(t);
    testing::put(model, "crank", {{0, 0}, a.value, {0, 0}, a.rate}, out);
    testing::put(model, "rod", {now.head<2>(), now[4], rate.head<2>(), rate[4]}, out);
    testing::put(model, "block", {now.segment<2>(2), 0, rate.segment<2>(2)}, out);
    return out;
  }
};

// Positions follow from the joints alone and are exact. The moment of the drive is its power
// divided by its speed.
TEST(SliderCrank, FollowsItsClosedFormKinematics) {
  const SliderCrank s;
  const double end = 1.7;
  const auto energy = [&](double dt) { return s.energy(end + dt); };
  const double moment = testing::first_difference(energy, 1e-3) / s.drive(end).rate;
  const auto run = [&](double h) {
    Workspace model = s.model();
    State x = s.at(model, 0);
    advance(model, x, end, h);
    const State exact = s.at(model, end);
    const size_t drive = model.joints().size() - 1;
    EXPECT_LT((x.q - exact.q).cwiseAbs().maxCoeff(), 1e-12);
    return Errors{0, (x.v - exact.v).cwiseAbs().maxCoeff(),
                  std::abs(x.lambda[model.first_row(drive)] - moment)};
  };
  for (const auto& [name, value] : {std::pair{"v", &Errors::v}, {"moment", &Errors::lambda}}) {
    const auto rate = testing::fit_rate({end / 400, end / 800, end / 1600},
                                        [&](double h) { return run(h).*value; });
    std::cout << "slider-crank: " << name << '\n' << rate.table();
    EXPECT_NEAR(rate.order(), 2, 0.1) << name << '\n' << rate.table();
  }
}

/// Returns x(t) of  m ẍ + c ẋ + k x = 0  from x(0) = x₀ at rest, and its rate.
Motion decaying(double mass, double damping, double stiffness, double start, double t) {
  const double delta = damping / (2 * mass);
  const double angular_frequency = std::sqrt(stiffness / mass - delta * delta);
  const double c = std::cos(angular_frequency * t), s = std::sin(angular_frequency * t),
               e = std::exp(-delta * t);
  return {start * e * (c + delta / angular_frequency * s),
          -start * e * (angular_frequency + delta * delta / angular_frequency) * s, 0};
}

// A block is on an inclined guide, with a spring to the ground; the force of the guide is m g cos.
TEST(Spring, MakesAnOscillator) {
  const double mass = 2, stiffness = 80, slope = 0.5, end = 2;
  const Vec2 along(std::cos(slope), std::sin(slope)), gravity(0, -kGravity);
  const double rest = 0.6 + mass * gravity.dot(along) / stiffness;
  for (const double damping : {0.0, 3.0})
    expect_order_two(damping > 0 ? "damped spring" : "spring", {4e-3, 2e-3, 1e-3}, [&](double h) {
      Workspace model;
      testing::add_rigid(model, "block", {mass, {0, 0}, 0.1}, gravity);
      model.add_joint(
          make_slider("guide", {.point = {0.2, 0.1}, .angle = slope}, {.body = "block"}));
      model.add_force_element(make_spring("spring", {.point = {0.2, 0.1}}, {.body = "block"},
                                          {stiffness, damping, 0.6}));
      State x = model.reference();
      testing::put(model, "block", {Vec2(0.2, 0.1) + (rest + 0.2) * along, slope}, x);
      advance(model, x, end, h);
      const Motion exact = decaying(mass, damping, stiffness, 0.2, end);
      // The tolerance of Newton's method, 1e-14 · 0.2 m, times m / (β h²), is 2e-8 N.
      const Vec2 across(-along.y(), along.x());
      const Vec3 guide = model.joint_wrench(1, "block", Vec3::Zero(), x).force;
      EXPECT_LT((Vec2(guide.head<2>()) - mass * kGravity * std::cos(slope) * across).norm(), 1e-7);
      return Errors{std::abs((x.q.head<2>() - Vec2(0.2, 0.1)).dot(along) - rest - exact.value),
                    std::abs(x.v.head<2>().dot(along) - exact.rate),
                    // The force of the guide is constant; therefore the spring's energy replaces a
                    // multiplier.
                    std::abs(model.energies(x).strain -
                             0.5 * stiffness * std::pow(rest - 0.6 + exact.value, 2))};
    });
}

// A spring wound up by several turns must unwind by the same angle: A sin t with A = 5 and 40, in
// both schemes.
TEST(TorsionSpring, CountsTurns) {
  for (const char* scheme : {"generalized_alpha", "minimal_coordinates"})
    for (const double rate : {5.0, 40.0}) {
      Workspace model;
      testing::add_rigid(model, "rotor", {1, {0, 0}, 1});
      model.add_joint(make_revolute("axis", {}, {.body = "rotor"}));
      model.add_force_element(make_torsion_spring("spring", {}, {.body = "rotor"}, {1, 0, 0}));
      State x = model.reference();
      testing::put(model, "rotor", {.angle_rate = rate}, x);
      IntegratorSettings settings;
      settings.name = scheme;
      const auto integrator = make_integrator(model, settings);
      integrator->make_consistent(x);
      double most = 0;
      for (int k = 1; k <= 6000; ++k) {
        integrator->advance(x, 1e-3 * k, [](const State&) {});
        const Energies e = model.energies(x);
        most = std::max(most, std::abs(e.kinetic + e.strain - 0.5 * rate * rate));
      }
      ASSERT_EQ(x.turned.size(), 1);
      // A step h rotates a body by about (h theta')^2/12 too little, for rho 0.8 by up to three
      // times that (the coordinates are the axes); the path there and back is the integral of rate
      // |cos t|.
      const double part = std::pow(1e-3 * rate, 2), way = rate * (4 + std::sin(6.0));
      EXPECT_NEAR(x.turned[0], rate * std::sin(6.0), 3 * part / 12 * way) << scheme;
      EXPECT_LT(most, part * 0.5 * rate * rate) << scheme;
    }
}

// A rest angle more than half a turn away is approached over the whole angle: rest (1 - cos t).
TEST(TorsionSpring, GoesTheWholeWayToItsRest) {
  Workspace model;
  testing::add_rigid(model, "rotor", {1, {0, 0}, 1});
  model.add_joint(make_revolute("axis", {}, {.body = "rotor"}));
  model.add_force_element(make_torsion_spring("spring", {}, {.body = "rotor"}, {1, 0, 4.0, 0.0}));
  State x = model.reference();
  testing::put(model, "rotor", {}, x);
  EXPECT_NEAR(model.energies(x).strain, 8, 1e-14);
  advance(model, x, 2.5, 1e-3);
  const double way = 4 * (1 - std::cos(2.5));
  // the tolerance is that of CountsTurns with theta' <= 4
  EXPECT_NEAR(x.turned[0], way, 3 * std::pow(4e-3, 2) / 12 * way);
}

TEST(TorsionSpring, MakesAnOscillator) {
  const RigidSection section{3, {0.2, 0.1}, 0.4};
  const double stiffness = 30, rest = 2.9, end = 2;  // the motion passes the branch cut at π
  const double inertia = section.inertia + section.mass * section.center.squaredNorm();
  for (const double damping : {0.0, 0.8})
    expect_order_two(
        damping > 0 ? "damped torsion spring" : "torsion spring", {4e-3, 2e-3, 1e-3},
        [&](double h) {
          Workspace model;
          testing::add_rigid(model, "rotor", section);
          model.add_joint(make_revolute("axis", {}, {.body = "rotor"}));
          model.add_force_element(make_torsion_spring("spring", {.angle = 0.3},
                                                      {.body = "rotor", .angle = -0.2},
                                                      {stiffness, damping, rest}));
          State x = model.reference();
          testing::put(model, "rotor", {{0, 0}, rest + 0.5 + 0.9}, x);
          advance(model, x, end, h);
          const Motion exact = decaying(inertia, damping, stiffness, 0.9, end);
          // The centre is not on the axis and needs a force to stay on its circle.
          const Vec2 arm = Eigen::Rotation2Dd(rest + 0.5 + exact.value) * section.center;
          const double spin = (-stiffness * exact.value - damping * exact.rate) / inertia;
          const Vec2 reaction =
              section.mass * (spin * Vec2(-arm.y(), arm.x()) - exact.rate * exact.rate * arm);
          return Errors{
              std::abs(
                  std::remainder(testing::angle_of(model, "rotor", x) - rest - 0.5 - exact.value,
                                 2 * std::numbers::pi)),
              std::abs(testing::angle_rate_of(model, "rotor", x) - exact.rate),
              (Vec2(model.joint_wrench(1, "rotor", Vec3::Zero(), x).force.head<2>()) - reaction)
                  .norm()};
        });
}

}  // namespace
}  // namespace flexmorph::fem
