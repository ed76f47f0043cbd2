// Shows that the energy-momentum scheme conserves energy, linear and angular momentum over 10⁴
// steps and converges with order 2: free, pinned, with a joint of degree 2 whose motion is known,
// with a driven hub, with material flow. Shows also the error without convergence.
#include "fem/dynamics/integrators/energy_momentum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "fem/dynamics/integrators/generalized_alpha.h"
#include "fem/dynamics/motion.h"
#include "fem/loads.h"
#include "fem/terms.h"
#include "tests/support/models.h"
#include "tests/support/particle_pendulum.h"
#include "tests/support/rates.h"

namespace flexmorph::fem {
namespace {

using testing::RotatingPlate;
using testing::ShapeSet;

struct Plate {
  ShapeSet shapes = ShapeSet::h16;
  double youngs_modulus = 1e6;
  int nx = 2, ny = 1;
  double strain = 0.05;  // of the free plate at the start
  bool gravity = false, pinned = false;
  PlaneSection section() const { return {0.01, youngs_modulus, 0.3, 2700}; }
};

Workspace make_model(const Plate& p) {
  std::vector<std::unique_ptr<Term>> terms;
  terms.push_back(make_inertia(p.section()));
  terms.push_back(make_membrane(p.section()));
  const Vec2 g(0, -9.81);
  const VectorXd gravity = p.gravity ? VectorXd(g) : VectorXd();
  if (p.gravity) terms.push_back(make_gravity(p.section(), g));
  terms.push_back(make_point_mass(0.3, {0.3, 0.1}, gravity));
  Workspace model;
  model.add_body("plate",
                 std::make_unique<AncfPlate>(2, p.shapes, testing::uniform_lines(0, 0.3, p.nx),
                                             testing::uniform_lines(-0.1, 0.1, p.ny)),
                 p.section(), std::move(terms));
  if (p.pinned)
    model.add_joint(make_pin("pin", "plate", {0, -0.1}, [](double) { return FrameMotion{}; }));
  return model;
}

/// Returns the state of a plate that translates, rotates at 6 rad/s, is strained by a multiple of
/// `strain` and deforms.
State flying(const Model& model, double strain) {
  State x = model.reference();
  const Body& body = model.bodies()[0];
  const auto& plate = dynamic_cast<const AncfPlate&>(*body.element);
  const VectorRows shape = testing::random_shape(plate, strain, 7),
                   rates = testing::random_shape(plate, 6 * strain, 8) - plate.reference();
  for (int k = 0; k < plate.n_vectors(); ++k) {
    const Vec2 r = shape.row(k);
    x.q.segment<2>(2 * k) = r;
    x.v.segment<2>(2 * k) = 6 * Vec2(-r.y(), r.x()) + Vec2(rates.row(k));
    if (plate.is_position(k)) x.v.segment<2>(2 * k) += Vec2(0.4, 0.3);
  }
  return x;
}

/// Returns the undeformed state without velocities, with a corner in the pin, hanging to the side.
State hanging(const Model& model) {
  State x = model.reference();
  const auto& plate = *model.bodies()[0].element;
  for (int k = 0; k < plate.n_vectors(); ++k)
    if (plate.is_position(k)) x.q[2 * k + 1] += 0.1;
  return x;
}

/// Returns ∫ ρh r × ṙ dA and ∫ ρh ṙ dA by 7 x 7 points, with the point mass of make_model().
Vec3 momenta(const Model& model, const State& x) {
  const Body& body = model.bodies()[0];
  const auto& plate = dynamic_cast<const AncfPlate&>(*body.element);
  const VectorRows q = rows_of(body, x.q), v = rows_of(body, x.v);
  Vec3 out = Vec3::Zero();
  const auto add = [&](double mass, const Vec2& r, const Vec2& r_t) {
    out += mass * Vec3(r_t.x(), r_t.y(), r.x() * r_t.y() - r.y() * r_t.x());
  };
  const GaussRule& rule = gauss(7);
  ShapeTable t;
  for (int e = 0; e < plate.n_elements(); ++e) {
    const int i = e / plate.n_n(), j = e % plate.n_n();
    const double area = (plate.line_m(i + 1).value - plate.line_m(i).value) *
                        (plate.line_n(j + 1).value - plate.line_n(j).value);
    const LocalRows qe = testing::rows_of_element(plate, q, e),
                    ve = testing::rows_of_element(plate, v, e);
    for (size_t a = 0; a < 7; ++a)
      for (size_t b = 0; b < 7; ++b) {
        plate.at(e, rule.points[a], rule.points[b], Tabulate::position, t);
        add(27 * area * rule.weights[a] * rule.weights[b], (t.N * qe).transpose(),
            (t.N * ve).transpose());
      }
  }
  const PointMotion tip = point_motion(body, x, {0.3, 0.1});
  add(0.3, tip.position, tip.velocity);
  return out;
}

struct Drift {
  double energy = 0, linear = 0, angular = 0;  // largest, relative
  double strain_min = 1e300, strain_max = 0, strain_scale = 0;
  StepCounts counts;
};

Drift drift(const Plate& p, double h, int steps) {
  Workspace model = make_model(p);
  EnergyMomentum scheme(model, {});
  State x = p.pinned ? hanging(model) : flying(model, p.strain);
  scheme.make_consistent(x);
  const Energies start = model.energies(x);
  const Vec3 momentum = momenta(model, x);
  Drift out;
  // The energy of a pendulum from rest is zero; therefore the scale is the largest kinetic energy.
  double scale = std::abs(start.total()), worst = 0;
  for (int k = 1; k <= steps; ++k)
    scheme.advance(x, k * h, [&](const State& y) {
      const Energies e = model.energies(y);
      scale = std::max(scale, e.kinetic);
      worst = std::max(worst, std::abs(e.total() - start.total()));
      out.strain_max = std::max(out.strain_max, e.strain);
      if (k > 1) out.strain_min = std::min(out.strain_min, e.strain);
      if (p.pinned || k % 50 != 0) return;  // the momenta by points are slow
      const Vec3 now = momenta(model, y) - momentum;
      out.linear = std::max(out.linear, now.head<2>().norm() / momentum.head<2>().norm());
      out.angular = std::max(out.angular, std::abs(now.z() / momentum.z()));
    });
  out.energy = worst / scale;
  out.strain_scale = scale;
  out.counts = scheme.counts();
  std::printf(
      "E %.0e, h %.0e, %d steps: energy %.1e, momentum %.1e, angular %.1e; strain energy %.2e"
      " to %.2e of %.2e J; %d Newton, %d factors, %d rejected\n",
      p.youngs_modulus, h, steps, out.energy, out.linear, out.angular, out.strain_min,
      out.strain_max, scale, out.counts.newton, out.counts.factorizations, out.counts.rejected);
  return out;
}

TEST(EnergyMomentumKeeps, EnergyAndMomentaOfAFlyingPlate) {
  const Drift d = drift({}, 1e-3, 10000);
  EXPECT_LT(d.energy, 1e-11);
  EXPECT_LT(d.linear, 1e-11);
  EXPECT_LT(d.angular, 1e-11);
  EXPECT_EQ(d.counts.steps, 10000);
  EXPECT_GT(d.strain_max, 0.01 * d.strain_scale);  // it deforms
}

// The frequencies of a stiff plate are far above the steps: the strain changes by about ε =
// (2U/EcA)^½ in each step, and has a round-off of about 1e-15 from the Gram entries, more far from
// the origin. Therefore each step causes an energy error of 1e-15 E c A ε, here 2e-13 J, for any
// tolerance of Newton's method, and a random walk over 10⁴ steps gives 2e-11 J, 1e-11 of the
// energy; ten times that is allowed. Momenta are not affected.
TEST(EnergyMomentumKeeps, MomentaOfAStiffPlateAndItsEnergyToTheRoundOffOfTheStrains) {
  Plate p;
  p.youngs_modulus = 1e8;
  p.strain = 0.002;
  const Drift d = drift(p, 1e-3, 10000);
  EXPECT_LT(d.energy, 1e-10);
  EXPECT_LT(d.linear, 1e-11);
  EXPECT_LT(d.angular, 1e-11);
  EXPECT_GT(d.strain_max, 0.01 * d.strain_scale);
}

TEST(EnergyMomentumKeeps, EnergyOfAPinnedPlateUnderGravity) {
  for (const double modulus : {1e6, 1e8}) {
    Plate p;
    p.youngs_modulus = modulus;
    p.gravity = p.pinned = true;
    const Drift d = drift(p, 1e-3, 10000);
    EXPECT_LT(d.energy, 1e-11);
  }
}

/// Returns the state at the end of n equal steps.
State run(Integrator& integrator, State x, double end, int n) {
  integrator.make_consistent(x);
  for (int k = 1; k <= n; ++k) integrator.advance(x, end * k / n, [](const State&) {});
  return x;
}

// q and v converge with order 2 to the limit of generalized-alpha (rho_inf 0.9) with small steps.
TEST(EnergyMomentum, ConvergesWithOrderTwoToTheLimitOfGeneralizedAlpha) {
  for (const bool pinned : {false, true}) {
    Plate p;
    p.youngs_modulus = 1e5;
    p.nx = 1;
    p.gravity = p.pinned = pinned;
    p.strain = 0.02;
    Workspace model = make_model(p);
    const State start = pinned ? hanging(model) : flying(model, p.strain);
    constexpr double kEnd = 0.08;
    AlphaSettings settings;
    settings.rho_inf = 0.9;
    GeneralizedAlpha alpha(model, settings);
    const State coarse = run(alpha, start, kEnd, 4000), fine = run(alpha, start, kEnd, 8000);
    const State limit{.t = kEnd,
                      .q = (4 * fine.q - coarse.q) / 3,
                      .v = (4 * fine.v - coarse.v) / 3,
                      .a = {},
                      .lambda = {},
                      .turned = {}};
    const VectorXd scales = model.scales();
    for (const bool velocity : {false, true}) {
      const auto rate = testing::fit_rate({8e-4, 4e-4, 2e-4, 1e-4}, [&](double h) {
        EnergyMomentum scheme(model, {});
        const State x = run(scheme, start, kEnd, static_cast<int>(std::lround(kEnd / h)));
        const VectorXd error = velocity ? x.v - limit.v : x.q - limit.q;
        return error.cwiseProduct(scales).lpNorm<Eigen::Infinity>();
      });
      std::cout << (pinned ? "pinned " : "free ") << (velocity ? "v" : "q") << '\n' << rate.table();
      EXPECT_NEAR(rate.order(), 2, 0.1) << rate.table();
    }
  }
}

struct SwingErrors {
  double q = 0, v = 0, mean_lambda = 0, lambda = 0, energy = 0, velocity_drift = 0;
};

/// Returns the errors of the pendulum on a rod of constant length, (|r|² - L²)/2 = 0.
SwingErrors swing(double h) {
  Workspace model = testing::particle_pendulum();
  EnergyMomentum scheme(model, {});
  State x = testing::swing_start(model);
  scheme.make_consistent(x);
  const double energy = model.energies(x).total(), end = 2;
  const int n = static_cast<int>(std::lround(end / h));
  SwingErrors out;
  double before = 0;
  for (int k = 1; k <= n; ++k)
    scheme.advance(x, end * k / n, [&](const State& y) {
      out.energy = std::max(out.energy, std::abs(model.energies(y).total() - energy));
      out.velocity_drift = std::max(out.velocity_drift, std::abs(y.q.dot(y.v)));
      if (k == n - 1) before = y.lambda[0];
      if (k == n) out.mean_lambda = 0.5 * (before + y.lambda[0]);
    });
  // The mean over the last two steps is the value between them, at the end of the last step but
  // one.
  out.mean_lambda = std::abs(out.mean_lambda - testing::exact_swing(end - h).lambda());
  const testing::Swing exact = testing::exact_swing(end);
  out.q = (x.q - exact.position()).norm();
  out.v = (x.v - exact.velocity()).norm();
  scheme.make_consistent(x);
  out.lambda = std::abs(x.lambda[0] - exact.lambda());
  return out;
}

TEST(EnergyMomentum, PendulumOnARodConvergesWithOrderTwoAndKeepsItsEnergy) {
  const std::vector<double> steps = {8e-3, 4e-3, 2e-3, 1e-3};
  for (const auto& [name, value] : {std::pair{"q", &SwingErrors::q},
                                    {"v", &SwingErrors::v},
                                    {"lambda, mean of two steps", &SwingErrors::mean_lambda},
                                    {"lambda, made consistent", &SwingErrors::lambda},
                                    {"velocity drift", &SwingErrors::velocity_drift}}) {
    const auto rate = testing::fit_rate(steps, [&](double h) { return swing(h).*value; });
    std::cout << name << '\n' << rate.table();
    EXPECT_NEAR(rate.order(), 2, 0.15) << name << '\n' << rate.table();
  }
  const double scale = 2 * 9.81 * 1;  // m g L
  EXPECT_LT(swing(1e-3).energy, 1e-12 * scale);
  EXPECT_LT(swing(4e-2).energy, 1e-12 * scale);
}

struct Grown {
  State x;
  VectorXd scales;
  double velocity_drift = 0, energy_error = 0;
};

/// Integrates the plate of P 4.2, which rotates with its hub and slides out, up to the first
/// insertion.
Grown grow(const std::string& integrator, double h, double speed, WeldMode weld) {
  RotatingPlate p;
  p.speed = speed;
  p.nx = 2;
  p.ny = 1;
  p.tip_mass = 0.1;
  p.weld = weld;
  p.section.youngs_modulus = 2e5;
  testing::Scene scene = testing::make_scene(p);
  MotionSettings settings;
  settings.integrator = integrator;
  settings.alpha.rho_inf = 0.9;
  settings.alpha.tolerance = 1e-14;  // steps of 10 us divide its errors by h²
  settings.step = h;
  settings.end = 0.04;
  const MotionResult r =
      integrate(scene.model, scene.moving_roots, settings, [](const MotionStep&) {});
  EXPECT_TRUE(r.events.empty());
  // Multipliers of both integrators come from one method.
  State x = r.final;
  make_integrator(scene.model, {})->make_consistent(x);
  return {x, scene.model.scales(), r.velocity_drift, r.energy_error};
}

// In a driven motion, with and without material flow, nothing is conserved, but everything is of
// order 2: unknowns, rates, multipliers at a stop, and the energy error of the balance.
TEST(EnergyMomentum, DrivenAndGrowingPlateConvergesWithOrderTwo) {
  struct Scene {
    double speed;
    WeldMode weld;
  };
  for (const Scene& s :
       {Scene{0, WeldMode::edge}, Scene{0.5, WeldMode::edge}, Scene{0.5, WeldMode::direction}}) {
    const State coarse = grow("generalized_alpha", 2e-5, s.speed, s.weld).x,
                fine = grow("generalized_alpha", 1e-5, s.speed, s.weld).x;
    std::vector<Grown> runs;
    const std::vector<double> steps = {2e-4, 1e-4, 5e-5};
    for (const double h : steps) {
      runs.push_back(grow("energy_momentum", h, s.speed, s.weld));
      EXPECT_LT(runs.back().velocity_drift, 1e-10);  // drives are satisfied
    }
    const auto check = [&](const char* name, const std::function<double(const Grown&)>& error) {
      testing::Rate rate;
      for (size_t i = 0; i < steps.size(); ++i) {
        rate.step.push_back(steps[i]);
        rate.error.push_back(error(runs[i]));
      }
      std::cout << "speed " << s.speed << ", " << name << '\n' << rate.table();
      EXPECT_NEAR(rate.order(), 2, 0.25) << name << '\n' << rate.table();
    };
    const auto limit = [&](VectorXd State::*field) {
      return VectorXd((4 * fine.*field - coarse.*field) / 3);
    };
    for (const auto& [name, field] :
         {std::pair{"q", &State::q}, {"v", &State::v}, {"lambda", &State::lambda}}) {
      const VectorXd at = limit(field);
      check(name, [&](const Grown& g) {
        const VectorXd error = g.x.*field - at;
        return error.size() == g.scales.size() ? error.cwiseProduct(g.scales).norm() : error.norm();
      });
    }
    if (s.speed > 0)
      check("energy defect", [](const Grown& g) { return g.energy_error; });
    else
      EXPECT_LT(runs.front().energy_error, 1e-8);  // a steady rotation
  }
}

TEST(EnergyMomentum, SaysWhatItCannotDo) {
  Plate p;
  p.gravity = p.pinned = true;
  Workspace model = make_model(p);
  State x = hanging(model);
  EnergyMomentumSettings settings;
  settings.max_iterations = 1;
  settings.max_halvings = 2;
  EnergyMomentum scheme(model, settings);
  scheme.make_consistent(x);
  const VectorXd q = x.q;
  try {
    scheme.advance(x, 0.1, [](const State&) {});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), Error::Kind::numerical);
    const std::string text = error.what();
    for (const char* part :
         {"energy_momentum", "converge", "t = 0 s", "step 1", "2 halvings", "1: |r|", "time.step"})
      EXPECT_NE(text.find(part), std::string::npos) << text;
  }
  EXPECT_EQ(x.q, q);  // the last good state
  EXPECT_EQ(scheme.counts().rejected, 3);

  // If the iterations suffice for small steps only, it recovers by halving.
  settings.max_iterations = 6;
  settings.max_halvings = 10;
  EnergyMomentum patient(model, settings);
  const double before = model.energies(x).total();
  double kinetic = 0;
  patient.advance(x, 0.3, [&](const State& y) { kinetic = model.energies(y).kinetic; });
  EXPECT_GT(patient.counts().rejected, 0);
  EXPECT_NEAR(model.energies(x).total(), before, 1e-12 * kinetic);
}

}  // namespace
}  // namespace flexmorph::fem
