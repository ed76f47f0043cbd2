// Shows that explicit integration in independent coordinates agrees with closed forms and implicit
// integrators: errors, constraints, energy, partitions, drives, flow; and that unsuitable models
// are refused.
#include "fem/dynamics/integrators/minimal_coordinates.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <numbers>

#include "fem/dynamics/integrators/generalized_alpha.h"
#include "fem/dynamics/motion.h"
#include "fem/loads.h"
#include "fem/terms.h"
#include "tests/support/differences.h"
#include "tests/support/drift.h"
#include "tests/support/errors.h"
#include "tests/support/models.h"
#include "tests/support/particle_pendulum.h"
#include "tests/support/rates.h"
#include "tests/support/rigid_models.h"

namespace flexmorph::fem {
namespace {

using testing::Drift;
using testing::error_of;
using testing::exact_swing;
using testing::mentions;
using testing::Swing;

constexpr double kGravity = 9.81;

void print(const std::string& what, const StepCounts& n, const Drift& d) {
  std::cout << what << ": " << n.steps << " steps, " << n.rejected << " rejected, " << n.evaluations
            << " evaluations, " << n.newton << " Newton, " << n.factorizations << " factors, "
            << n.partitions << " partitions; drift " << d.position << " m, " << d.velocity
            << " m/s, " << d.acceleration << " m/s^2\n";
}

struct Swung {
  double q = 0, v = 0, lambda = 0;  // errors at the end
  Drift drift;
  StepCounts counts;
};

Swung swing(double tolerance, double end = 2) {
  Workspace model = testing::particle_pendulum();
  MinimalCoordinates scheme(model, {tolerance});
  State x = testing::swing_start(model);
  scheme.make_consistent(x);
  Swung out;
  scheme.advance(x, end, [&](const State& y) { out.drift.see(model, y); });
  EXPECT_EQ(x.t, end);
  const Swing s = exact_swing(end);
  out.q = (x.q - s.position()).norm();
  out.v = (x.v - s.velocity()).norm();
  out.lambda = std::abs(x.lambda[0] - s.lambda());
  out.counts = scheme.counts();
  return out;
}

// The constraint is satisfied to round-off of r·r, r·v and r·a + v·v (1, 5 and 30 SI units).
TEST(MinimalCoordinates, FollowsAPendulumToNineDigitsWithoutDrift) {
  const Swung e = swing(1e-11);
  print("pendulum", e.counts, e.drift);
  std::cout << "errors " << e.q << " m, " << e.v << " m/s, " << e.lambda << " N/m\n";
  EXPECT_LT(e.q, 1e-9);
  EXPECT_LT(e.v, 4e-9);
  EXPECT_LT(e.lambda, 5e-8);
  EXPECT_LT(e.drift.position, 1e-15);
  EXPECT_LT(e.drift.velocity, 1e-14);
  EXPECT_LT(e.drift.acceleration, 1e-13);
}

// The local error, C h⁵, is kept at the tolerance; the error at the end is proportional to it.
TEST(MinimalCoordinates, ErrorFollowsTheTolerance) {
  const auto rate = testing::fit_rate({1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10}, [](double tolerance) {
    const Swung e = swing(tolerance);
    return e.q + 0.3 * e.v;
  });
  std::cout << "by tolerance\n" << rate.table();
  EXPECT_NEAR(rate.order(), 1, 0.2) << rate.table();
  EXPECT_LT(rate.error.front(), 100 * rate.step.front());
}

// A block on a guide with a spring moves as x = x₀ + A cos ωt: the order is 5 in the mean step.
TEST(MinimalCoordinates, ConvergesWithOrderFive) {
  const double mass = 2, stiffness = 80, rest = 0.6, amplitude = 0.2, end = 2;
  const double omega = std::sqrt(stiffness / mass);
  testing::Rate rate;
  for (const double tolerance : {1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10}) {
    Workspace model;
    testing::add_rigid(model, "block", {mass, {0, 0}, 0.1});
    model.add_joint(make_slider("guide", {}, {.body = "block"}));
    model.add_force_element(make_spring("spring", {}, {.body = "block"}, {stiffness, 0, rest}));
    State x = model.reference();
    testing::put(model, "block", {{rest + amplitude, 0}, 0}, x);
    MinimalCoordinates scheme(model, {tolerance});
    scheme.make_consistent(x);
    scheme.advance(x, end, [](const State&) {});
    rate.step.push_back(end / scheme.counts().steps);
    rate.error.push_back(std::abs(x.q[0] - rest - amplitude * std::cos(omega * end)) +
                         std::abs(x.v[0] + amplitude * omega * std::sin(omega * end)) / omega);
    EXPECT_EQ(scheme.counts().partitions, 1);
  }
  std::cout << "by step\n" << rate.table();
  EXPECT_NEAR(rate.order(), 5, 0.3) << rate.table();
}

/// A crank, its rod, and a block that slides on a line through the axis of the crank; no gravity.
struct SliderCrank {
  double crank = 0.15, rod = 0.4;
  RigidSection crank_section{1.2, {0.06, 0.01}, 0.004}, rod_section{0.8, {0.21, -0.02}, 0.011},
      block_section{0.5, {0, 0}, 0.001};
  bool massless_block = false;
  std::function<Motion(double)> drive;

  Workspace model() const {
    Workspace out;
    testing::add_rigid(out, "crank", crank_section);
    testing::add_rigid(out, "rod", rod_section);
    if (massless_block) {
      out.add_body("block", std::make_unique<RigidBody>(0.05), {}, {});
      out.add_joint(make_unit_axis("unit axis of block", "block"));
    } else {
      testing::add_rigid(out, "block", block_section);
    }
    out.add_joint(make_revolute("axis", {}, {.body = "crank"}));
    out.add_joint(
        make_revolute("crank pin", {.body = "crank", .point = {crank, 0}}, {.body = "rod"}));
    out.add_joint(
        make_revolute("wrist pin", {.body = "rod", .point = {rod, 0}}, {.body = "block"}));
    out.add_joint(make_slider("guide", {}, {.body = "block"}));
    if (drive) out.add_joint(make_angle_drive("drive", {}, {.body = "crank"}, drive));
    return out;
  }
  /// Returns the closed form: sin b = -(crank / rod) sin a.
  State at(const Model& model, const Motion& a) const {
    const double sa = std::sin(a.value), ca = std::cos(a.value);
    const double b = std::asin(-crank / rod * sa), rate = -crank / rod * ca * a.rate / std::cos(b);
    State out = model.reference();
    const Vec2 pin(crank * ca, crank * sa), pin_rate = a.rate * Vec2(-pin.y(), pin.x());
    testing::put(model, "crank", {{0, 0}, a.value, {0, 0}, a.rate}, out);
    testing::put(model, "rod", {pin, b, pin_rate, rate}, out);
    const Vec2 arm = rod * Vec2(std::cos(b), std::sin(b));
    testing::put(model, "block",
                 {{(pin + arm).x(), 0}, 0, {(pin_rate + rate * Vec2(-arm.y(), arm.x())).x(), 0}},
                 out);
    return out;
  }
};

struct Turned {
  State end;
  double energy = 0;  // largest relative change of the energy
  Drift drift;
  StepCounts counts;
};

Turned turn(const SliderCrank& s, double end, const IntegratorSettings& settings, int n) {
  Workspace model = s.model();
  const auto scheme = make_integrator(model, settings);
  Turned out;
  out.end = s.at(model, {0.4, 12, 0});
  scheme->make_consistent(out.end);
  const double start = model.energies(out.end).total();
  for (int k = 1; k <= n; ++k)
    scheme->advance(out.end, end * k / n, [&](const State& y) {
      out.energy = std::max(out.energy, std::abs(model.energies(y).total() / start - 1));
      out.drift.see(model, y);
    });
  out.counts = scheme->counts();
  return out;
}

IntegratorSettings minimal(double tolerance) {
  IntegratorSettings out;
  out.name = "minimal_coordinates";
  out.minimal_coordinates.tolerance = tolerance;
  return out;
}

// No coordinate is independent over 2.5 revolutions. The expected state is extrapolated.
TEST(MinimalCoordinates, TurnsACrankThroughSeveralPartitions) {
  const double end = 1.3;
  for (const bool massless : {false, true}) {
    SliderCrank s;
    s.massless_block = massless;
    const Turned e = turn(s, end, minimal(1e-10), 1);
    print(massless ? "crank, massless block" : "crank", e.counts, e.drift);
    std::cout << "energy " << e.energy << '\n';
    EXPECT_GE(e.counts.partitions, 4);
    EXPECT_LT(e.energy, 1e-8);
    EXPECT_LT(e.drift.position, 1e-15);
    EXPECT_LT(e.drift.velocity, 1e-13);
    EXPECT_LT(e.drift.acceleration, 1e-10);  // accelerations are up to 1e3 m/s²
    IntegratorSettings alpha;
    alpha.alpha.tolerance = 1e-14;
    const State coarse = turn(s, end, alpha, 4000).end, fine = turn(s, end, alpha, 8000).end;
    EXPECT_LT((e.end.q - (4 * fine.q - coarse.q) / 3).lpNorm<Eigen::Infinity>(), 2e-7);
    EXPECT_LT((e.end.v - (4 * fine.v - coarse.v) / 3).lpNorm<Eigen::Infinity>(), 2e-6);
  }
}

// No coordinate is independent: every step is pure kinematics and must equal the closed form.
TEST(MinimalCoordinates, FollowsADrivenMechanism) {
  SliderCrank s;
  s.drive = [](double t) { return Motion{0.4 + 12 * t + 2 * t * t, 12 + 4 * t, 4}; };
  Workspace model = s.model();
  MinimalCoordinates scheme(model, {});
  State x = s.at(model, s.drive(0));
  scheme.make_consistent(x);
  Drift drift;
  for (int k = 1; k <= 100; ++k) {
    scheme.advance(x, 0.013 * k, [&](const State& y) { drift.see(model, y); });
    const State exact = s.at(model, s.drive(x.t));
    EXPECT_LT((x.q - exact.q).lpNorm<Eigen::Infinity>(), 1e-14);
    EXPECT_LT((x.v - exact.v).lpNorm<Eigen::Infinity>(), 1e-12);
  }
  print("driven crank", scheme.counts(), drift);
  // The power of the drive is the rate of the energy.
  const auto energy = [&](double t) { return model.energies(s.at(model, s.drive(t))).total(); };
  const double power = testing::first_difference([&](double dt) { return energy(x.t + dt); }, 2e-4);
  EXPECT_NEAR(x.lambda[model.first_row(model.joints().size() - 1)] * s.drive(x.t).rate / power, 1,
              1e-8);
}

/// Returns a planar plate that is pinned at a corner and released from the horizontal.
Workspace plate_pendulum(double youngs_modulus, int n) {
  const PlaneSection section{0.01, youngs_modulus, 0.3, 7810};
  std::vector<std::unique_ptr<Term>> terms;
  terms.push_back(make_inertia(section));
  terms.push_back(make_membrane(section));
  terms.push_back(make_gravity(section, Vec2(0, -kGravity)));
  Workspace model;
  model.add_body(
      "plate",
      std::make_unique<AncfPlate>(2, testing::ShapeSet::h16, testing::uniform_lines(0, 0.3, n),
                                  testing::uniform_lines(0, 0.3, n)),
      section, std::move(terms));
  model.add_joint(make_pin("pin", "plate", {0, 0}, [](double) { return FrameMotion{}; }));
  return model;
}

TEST(MinimalCoordinates, FollowsAFlexiblePlateWithItsEnergy) {
  Workspace model = plate_pendulum(1e6, 2);
  const double end = 0.15;
  MinimalCoordinates scheme(model, {1e-9});
  State x = model.reference();
  scheme.make_consistent(x);
  const double start = model.energies(x).total();
  double worst = 0;
  Drift drift;
  scheme.advance(x, end, [&](const State& y) {
    worst = std::max(worst, std::abs(model.energies(y).total() - start));
    drift.see(model, y);
  });
  const Energies e = model.energies(x);
  print("plate", scheme.counts(), drift);
  std::cout << "energy " << worst << " J of " << e.kinetic << " J kinetic, " << e.strain
            << " J strain\n";
  EXPECT_GT(e.kinetic, 1);
  EXPECT_LT(worst, 1e-7 * e.kinetic);
  EXPECT_EQ(scheme.counts().factorizations, 1);  // M and Φ_q are constant
  EXPECT_LT(drift.position, 1e-15);
  const auto alpha_end = [&](int n) {
    GeneralizedAlpha alpha(model, {{}, 0.9});
    State y = model.reference();
    alpha.make_consistent(y);
    for (int k = 1; k <= n; ++k) alpha.advance(y, end * k / n, [](const State&) {});
    return y.q;
  };
  const VectorXd coarse = alpha_end(1500), fine = alpha_end(3000);
  const double off = (x.q - (4 * fine - coarse) / 3).cwiseProduct(model.scales()).norm();
  std::cout << "difference to generalized_alpha, extrapolated: " << off << " m\n";
  EXPECT_LT(off, 1e-6);
}

// A plate rotates with a hub and slides out of it: the mass changes, and the root is driven. In the
// second case a node is inserted at 0.037 s, which releases energy of the stiffer mesh.
TEST(MinimalCoordinates, FollowsMaterialThatFlows) {
  testing::RotatingPlate plate;
  plate.section = {0.01, 1e6, 0.3, 2700};
  plate.speed = 0.5;
  plate.nx = 3;
  plate.ny = 1;
  MotionSettings settings;
  settings.end = 0.05;
  settings.minimal_coordinates.tolerance = 1e-9;
  for (const bool node : {false, true}) {
    const auto run = [&](const std::string& name, double step) {
      testing::Scene scene = testing::make_scene(plate);
      if (node) scene.moving_roots[0].max_length = 0.185;  // it is 0.167 m at the start
      settings.integrator = name;
      settings.step = step;
      MotionResult out =
          integrate(scene.model, scene.moving_roots, settings, [](const MotionStep&) {});
      out.final.q.array() *= scene.model.scales().array();  // displacements [m]
      return out;
    };
    const MotionResult r = run("minimal_coordinates", 5e-3);
    const double coarse =
        (run("generalized_alpha", 1e-4).final.q - r.final.q).lpNorm<Eigen::Infinity>();
    const double fine =
        (run("generalized_alpha", 5e-5).final.q - r.final.q).lpNorm<Eigen::Infinity>();
    std::cout << "growing plate: " << r.counts.steps << " steps, " << r.counts.evaluations
              << " evaluations, drift " << r.constraint_drift << " m, " << r.velocity_drift
              << " m/s, energy defect " << r.energy_error << ", generalized_alpha is off by "
              << coarse << " and " << fine << " m\n";
    EXPECT_EQ(r.events.size(), node ? 1U : 0U);
    EXPECT_GT(coarse, 3 * fine);
    EXPECT_LT(fine, 1e-5);
    double released = 0;  // relative to the kinetic energy
    for (const MeshEvent& e : r.events)
      released += std::abs(e.after.total() - e.before.total()) / e.before.kinetic;
    EXPECT_LT(released, 1e-5);
    EXPECT_LT(r.energy_error, released + 1e-6);
    EXPECT_LT(r.constraint_drift, 1e-14);
    EXPECT_LT(r.velocity_drift, 1e-12);
  }
}

TEST(MinimalCoordinates, SaysWhatIsStiff) {
  Workspace model = plate_pendulum(2e11, 2);
  MinimalCoordinatesSettings settings;
  settings.max_steps = 300;
  MinimalCoordinates scheme(model, settings);
  State x = model.reference();
  scheme.make_consistent(x);
  const std::string text =
      error_of(Error::Kind::numerical, [&] { scheme.advance(x, 0.1, [](const State&) {}); });
  std::cout << text << '\n';
  for (const char* part : {"step size", "stiff", "rad/s", "generalized_alpha"})
    EXPECT_TRUE(mentions(text, part)) << part << ": " << text;
  EXPECT_GT(x.t, 0);  // x is the last good state
  EXPECT_TRUE(x.q.allFinite());
  Drift drift;
  drift.see(model, x);
  EXPECT_LT(drift.position, 1e-15);
}

// The rod is shorter than the crank; therefore the mechanism locks during the motion.
TEST(MinimalCoordinates, StopsWhereAMechanismLocks) {
  SliderCrank s;
  s.crank = 0.45;
  s.drive = [](double t) { return Motion{0.4 + t, 1, 0}; };
  Workspace model = s.model();
  MinimalCoordinates scheme(model, {});
  State x = s.at(model, s.drive(0));
  scheme.make_consistent(x);
  const std::string text =
      error_of(Error::Kind::numerical, [&] { scheme.advance(x, 1, [](const State&) {}); });
  const double locks = std::asin(s.rod / s.crank) - 0.4;
  std::cout << text << ", locks at " << locks << " s\n";
  EXPECT_TRUE(mentions(text, "t = ") && mentions(text, "step size")) << text;
  EXPECT_NEAR(x.t, locks, 1e-6);
  EXPECT_LE(x.t, locks);
}

TEST(MinimalCoordinates, RefusesWhatHasNoAccelerations) {
  const SliderCrank s;
  {  // redundant joints are named
    Workspace model = s.model();
    model.add_joint(make_revolute("second axis", {}, {.body = "crank"}));
    MinimalCoordinates scheme(model, {});
    State x = s.at(model, {0.4, 0, 0});
    const std::string text = error_of(Error::Kind::numerical, [&] { scheme.make_consistent(x); });
    for (const char* part : {"dependent", "'axis'", "'second axis'", "2 degrees of freedom"})
      EXPECT_TRUE(mentions(text, part)) << part << ": " << text;
  }
  {  // the massless block can move along its guide
    Workspace model;
    model.add_body("block", std::make_unique<RigidBody>(0.05), {}, {});
    model.add_joint(make_unit_axis("unit axis", "block"));
    model.add_joint(make_slider("guide", {}, {.body = "block"}));
    testing::add_rigid(model, "other", {1, {0, 0}, 1});
    MinimalCoordinates scheme(model, {});
    State x = model.reference();
    const std::string text = error_of(Error::Kind::input, [&] { scheme.make_consistent(x); });
    EXPECT_TRUE(mentions(text, "mass") && mentions(text, "'block'")) << text;
    EXPECT_FALSE(mentions(text, "'other'")) << text;
  }
  Workspace model = s.model();
  for (const double tolerance : {0.0, 1e-15, 1.0, std::nan("")}) {
    const auto make = [&] { make_integrator(model, minimal(tolerance)); };
    EXPECT_TRUE(mentions(error_of(Error::Kind::input, make), "[1e-13, 1)"));
  }
}

TEST(MinimalCoordinates, IsReproducibleBitForBit) {
  const SliderCrank s;
  const State one = turn(s, 0.7, minimal(1e-8), 7).end, other = turn(s, 0.7, minimal(1e-8), 7).end;
  EXPECT_TRUE(one.q == other.q && one.v == other.v);
  EXPECT_EQ(one.lambda, other.lambda);
}

}  // namespace
}  // namespace flexmorph::fem
