// Shows that damped bodies move correctly: the decay and the frequency of the first bending mode of
// a free beam and of a free strip in space are the closed form of stiffness-proportional damping;
// the energy error of the balance with dissipation is of second order; and energy_momentum
// dissipates the energy of its balance.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <numbers>

#include "fem/dynamics/balance.h"
#include "fem/dynamics/integrators/integrator.h"
#include "fem/elements/ancf_beam.h"
#include "fem/model/workspace.h"
#include "fem/terms.h"
#include "tests/support/dense.h"
#include "tests/support/models.h"
#include "tests/support/rates.h"

namespace flexmorph::fem {
namespace {

using Names = std::vector<std::string>;

constexpr double kLength = 1, kThickness = 0.01;
const PlaneSection kSection{kThickness, 1e9, 0.3, 1000};

/// Returns a free beam of height kThickness, or a free strip in space of that thickness.
Workspace free_body(const Names& terms, double damping_time) {
  Workspace model;
  std::unique_ptr<Element> element;
  if (terms[1] == "ecm")
    element = std::make_unique<AncfBeam>(kLength, kThickness, 6);
  else
    element = std::make_unique<AncfPlate>(3, testing::ShapeSet::h16,
                                          testing::uniform_lines(0, kLength, 4),
                                          testing::uniform_lines(0, 0.05, 1));
  model.add_body("body", std::move(element), kSection,
                 make_terms(terms, kSection, {{"damping_time", damping_time}}));
  return model;
}

/// The first elastic mode.
struct Mode {
  double angular_frequency = 0;
  VectorXd shape, momentum;  // φ with φᵀ M φ = 1; M φ
};
Mode first_mode(Workspace& model) {
  const State x = model.reference();
  model.prepare(0.0);
  Constraints none;
  model.constraints(x, none);
  SparseMatrix stiffness, mass;
  model.kkt(x, none, {1, 0, 0}, 1, stiffness);
  model.kkt(x, none, {0, 0, 1}, 1, mass);
  const testing::Modes modes = testing::modes(MatrixXd(stiffness), MatrixXd(mass));
  const Eigen::Index rigid = model.bodies()[0].element->dim() == 2 ? 3 : 6;
  Mode out;
  out.angular_frequency = std::sqrt(modes.values[rigid]);
  out.shape = modes.vectors.col(rigid);
  out.momentum = mass * out.shape;
  return out;
}

/// With σ = τω²/2 and ω_d² = ω² - σ², the modal coordinate a = e^(-σt) (...) has (ȧ + σ a)² + ω_d²
/// a² ~ e^(-2σt): the decay rate follows from the ends of the motion, the frequency from the zeros.
TEST(Decay, OfTheFirstBendingModeIsTheClosedForm) {
  constexpr double ratio = 0.05;  // ζ
  constexpr int periods = 6, steps_per_period = 400;
  for (const Names& terms :
       {Names{"inertia", "ecm", "damping"}, Names{"inertia", "membrane", "bending", "damping"},
        Names{"inertia", "membrane_assumed", "bending", "damping"}}) {
    Workspace still = free_body(terms, 1);
    const double omega = first_mode(still).angular_frequency, tau = 2 * ratio / omega;
    Workspace model = free_body(terms, tau);
    const Mode mode = first_mode(model);
    // A free Euler-Bernoulli beam has (4.7300)² sqrt(E I / (ρ A)) / L²; the modulus of a strip is
    // between E and E / (1 - ν²).
    const double slender = std::pow(4.730040745 / kLength, 2) * kThickness *
                           std::sqrt(kSection.youngs_modulus / (12 * kSection.density));
    EXPECT_GT(mode.angular_frequency, 0.995 * slender);
    EXPECT_LT(mode.angular_frequency, slender / std::sqrt(1 - 0.09));

    const double sigma = 0.5 * tau * omega * omega,
                 omega_d = std::sqrt(omega * omega - sigma * sigma);
    State x = model.reference();
    const VectorXd rest = x.q;
    x.v = 1e-4 * kLength * omega * mode.shape / mode.shape.lpNorm<Eigen::Infinity>();
    IntegratorSettings settings;
    settings.alpha.rho_inf = 1;  // no numerical damping
    const auto alpha = make_integrator(model, settings);
    alpha->make_consistent(x);
    const double h = 2 * std::numbers::pi / omega / steps_per_period;
    const auto size = [&](const State& at) {
      const double a = mode.momentum.dot(at.q - rest), rate = mode.momentum.dot(at.v);
      return std::pow(rate + sigma * a, 2) + std::pow(omega_d * a, 2);
    };
    const double start = size(x);
    std::vector<double> zeros;
    double before = 0;
    const int n = periods * steps_per_period;
    for (int k = 1; k <= n; ++k)
      alpha->advance(x, k * h, [&](const State& at) {
        const double a = mode.momentum.dot(at.q - rest);
        if (before * a < 0) zeros.push_back(at.t - h * a / (a - before));
        before = a;
      });
    const double decay = -0.5 * std::log(size(x) / start) / x.t;
    ASSERT_GT(zeros.size(), 4u);
    const double swing =
        std::numbers::pi * static_cast<double>(zeros.size() - 1) / (zeros.back() - zeros.front());
    std::cout << terms[1] << ": decay " << decay / sigma - 1 << ", frequency "
              << swing / omega_d - 1 << " off the closed form\n";
    EXPECT_NEAR(decay, sigma, 1e-3 * sigma);
    EXPECT_NEAR(swing, omega_d, 1e-3 * omega_d);
  }
}

struct Outcome {
  double energy_error = 0, dissipated = 0, energy = 0;  // relative to the initial energy
  Vec3 momentum = Vec3::Zero();
};
/// Integrates a free body that is bent, rotates [rad/s] and translates.
Outcome run(const Names& terms, const std::string& integrator, double spin, double h, double end) {
  Workspace model = free_body(terms, 2e-3);
  const Mode mode = first_mode(model);
  State x = model.reference();
  x.v = 0.02 * kLength * mode.angular_frequency * mode.shape / mode.shape.lpNorm<Eigen::Infinity>();
  const Element& element = *model.bodies()[0].element;
  for (int k = 0; k < element.n_vectors(); ++k) {
    const int at = element.dim() * k;
    x.v[at] -= spin * x.q[at + 1];
    x.v[at + 1] += spin * x.q[at];
    if (element.is_position(k)) x.v[at] += 0.3;
  }
  IntegratorSettings settings;
  settings.name = integrator;
  const auto steps = make_integrator(model, settings);
  steps->make_consistent(x);
  EnergyBalance balance;
  const Energies first = model.energies(x);
  balance.begin(0, first, powers(model, x));
  const int n = static_cast<int>(std::lround(end / h));
  for (int k = 1; k <= n; ++k)
    steps->advance(x, end * k / n, [&](const State& at) {
      const Energies now = model.energies(at);
      if (const State* mean = steps->step_mean()) {
        model.prepare(*mean);
        balance.add_mean(at.t, now, powers(model, *mean));
        model.prepare(at);
      } else {
        balance.add(at.t, now, powers(model, at));
      }
    });
  EXPECT_NEAR(balance.work(), -balance.dissipated(), 1e-15 * first.total());
  return {balance.energy_error() / first.total(), balance.dissipated() / first.total(),
          model.energies(x).total() / first.total(), model.momentum(x)};
}

TEST(Balance, HasADefectOfSecondOrderWithDamping) {
  const auto rate = testing::fit_rate({2e-3, 1e-3, 5e-4, 2.5e-4}, [](double h) {
    const Outcome out = run({"inertia", "ecm", "damping"}, "generalized_alpha", 0, h, 0.1);
    EXPECT_GT(out.dissipated, 1e-3);
    return std::abs(out.energy_error);
  });
  EXPECT_NEAR(rate.order(), 2, 0.2) << rate.table();
  std::cout << rate.table();
}

// The tolerance is round-off of Newton's method, and in space the error of GramGradient for
// elements that hardly deform. The momentum of the translation does not change.
TEST(EnergyMomentum, TakesOutWhatItCounts) {
  for (const Names& terms :
       {Names{"inertia", "ecm", "damping"}, Names{"inertia", "membrane", "bending", "damping"}}) {
    const Outcome out = run(terms, "energy_momentum", 3, 1e-3, 0.05),
                  start = run(terms, "energy_momentum", 3, 1e-3, 1e-3);
    EXPECT_GT(out.dissipated, 1e-3);
    EXPECT_NEAR(out.energy + out.dissipated, 1, 1e-9);
    EXPECT_LT((out.momentum - start.momentum).norm(), 1e-11 * start.momentum.norm());
  }
}

}  // namespace
}  // namespace flexmorph::fem
