// Shows that the rod of the slider-crank of T section 11.2 moves as an independent model of small
// deflections does, where heat moves the slider, and the effect of a sudden temperature.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "cases/results/series.h"
#include "cases/run/motion_run.h"
#include "tests/cases/scenes.h"
#include "tests/support/rates.h"

namespace flexmorph::cases {
namespace {

constexpr double kCrank = 0.152, kRod = 0.304, kAlpha = 80e-6;

MotionRecord run(const Changes& changes) {
  return run_motion(PreparedCase(read("slider_crank_heated", changes)), {}).record;
}

/// An Euler-Bernoulli rod between its pins with small deflections w(x, t) across the line between
/// the pins, which moves as the rigid rod does:
///
///   EI w'''' - (N w')' + m (w_tt - θ_t² w) = -m (A_tt · e₂ + x θ_tt),   w = Σ a_n sin(nπx/L)
///
/// A is the crank pin, e₁, e₂ are the axes of the line, and N is the axial force of the rigid rod,
/// whose end is pushed only across the guide: N(L) = R sin θ, R cos θ L = ∫ m x (A_tt · e₂ + x
/// θ_tt) dx.
class SmallDeflections {
 public:
  SmallDeflections(double bending, double mass) : bending_(bending), mass_(mass) {}

  /// Returns the deflections of the middle at t = k h by the Runge-Kutta method of fourth order.
  std::vector<double> middle(double h, int steps) const {
    State y{};
    std::vector<double> out = {0};
    for (int k = 0; k < steps; ++k) {
      const double t = k * h;
      const State a = rate(t, y), b = rate(t + h / 2, plus(y, a, h / 2)),
                  c = rate(t + h / 2, plus(y, b, h / 2)), d = rate(t + h, plus(y, c, h));
      for (size_t i = 0; i < y.size(); ++i) y[i] += h / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]);
      double w = 0;
      for (size_t n = 0; n < kModes; ++n)
        w += y[n] * std::sin(0.5 * std::numbers::pi * double(n + 1));
      out.push_back(w);
    }
    return out;
  }

 private:
  static constexpr size_t kModes = 4;
  using State = std::array<double, 2 * kModes>;

  static State plus(State y, const State& rate, double h) {
    for (size_t i = 0; i < y.size(); ++i) y[i] += h * rate[i];
    return y;
  }

  State rate(double t, const State& y) const {
    // sin θ = -r sin φ / L with φ = π t, and the derivatives of sin θ.
    const double phi = std::numbers::pi * t, k = kCrank / kRod;
    const double s = -k * std::sin(phi), c = std::sqrt(1 - s * s);
    const double s_t = -k * std::numbers::pi * std::cos(phi),
                 s_tt = -std::numbers::pi * std::numbers::pi * s;
    const double theta_t = s_t / c, theta_tt = (s_tt + s * theta_t * theta_t) / c;
    const double ax = -kCrank * std::numbers::pi * std::numbers::pi * std::cos(phi),
                 ay = -kCrank * std::numbers::pi * std::numbers::pi * std::sin(phi);
    const double along = ax * c + ay * s, across = -ax * s + ay * c;
    const double push = mass_ * (across * kRod / 2 + theta_tt * kRod * kRod / 3) / c * s;
    State out{};
    for (size_t n = 0; n < kModes; ++n) {
      const double p = double(n + 1) * std::numbers::pi / kRod;
      double force = -bending_ * std::pow(p, 4) * 0.5 * kRod * y[n];
      // the error of the mid-point rule is far below the tolerance of the comparison
      constexpr int kPoints = 60;
      for (int i = 0; i < kPoints; ++i) {
        const double x = (i + 0.5) * kRod / kPoints, dx = kRod / kPoints;
        const double rest = kRod - x;
        const double axial =
            push - mass_ * (along * rest - theta_t * theta_t * (kRod * kRod - x * x) / 2);
        double slope = 0;
        for (size_t j = 0; j < kModes; ++j) {
          const double pj = double(j + 1) * std::numbers::pi / kRod;
          slope += y[j] * pj * std::cos(pj * x);
        }
        force -= dx * axial * slope * p * std::cos(p * x);
        force -= dx * mass_ * (across + x * theta_tt) * std::sin(p * x);
      }
      out[n] = y[kModes + n];
      out[kModes + n] = force / (0.5 * mass_ * kRod) + theta_t * theta_t * y[n];
    }
    return out;
  }

  double bending_, mass_;
};

// The deflections differ by at most 3 % of the largest deflection over the whole turn. Finer meshes
// (48 elements) agree equally well; the six elements of the paper differ by 13 %. The bending
// stiffness is E I for "ecm" and E I / (1 - ν²) for "gcm".
TEST(SliderCrank, ColdRodFollowsTheSmallDeflectionModel) {
  const double E = 2e8, h = 5.76e-3, b = 5.5e-3, EI = E * b * h * h * h / 12;
  for (const auto& [model, bending] : {std::pair{"ecm", EI}, {"gcm", EI / (1 - 0.09)}}) {
    const MotionRecord r = run({"body.heat.rise=0", "time.step=2e-3", "body.elements=24",
                                std::string("body.terms=[\"inertia\", \"") + model + "\"]"});
    const std::vector<double>& w = r.table.at("rod.midpoint_deflection");
    const std::vector<double> expected = SmallDeflections(bending, 7200 * h * b).middle(1e-3, 2000);
    ASSERT_EQ(w.size(), 1001u);
    const double size = largest_size(expected);
    EXPECT_GT(size, 1e-3);
    for (size_t k = 0; k < w.size(); ++k)
      ASSERT_NEAR(w[k], expected[2 * k], 0.03 * size) << model << " at " << r.time()[k];
  }
}

// A massless slider does not hinder the expansion of the rod. The slider lies further out by α ΔT
// L, reduced slightly by the bending of the rod, and the strains of the hot rod are those of the
// cold rod.
TEST(SliderCrank, HeatMovesTheSliderAndLeavesNoStress) {
  const MotionRecord cold = run({"body.heat.rise=0", "time.step=2e-3"}),
                     hot = run({"body.heat.rise=200", "time.step=2e-3"});
  const double shift = hot.table.at("rod.slider_x").back() - cold.table.at("rod.slider_x").back();
  EXPECT_NEAR(shift, kAlpha * 200 * kRod, 5e-5);
  const double strain = largest_size(cold.table.at("rod.max_elastic_strain"));
  // The hot rod is longer by α ΔT, and strains refer to its length.
  EXPECT_NEAR(largest_size(hot.table.at("rod.max_elastic_strain")) / strain, 1, 2 * kAlpha * 200);
  EXPECT_LT(strain, 0.1 * kAlpha * 200);  // a held rod would have the strain α ΔT
}

TEST(SliderCrank, DeflectionConvergesWithOrderTwoInTheStep) {
  const auto at_end = [](double h) {
    return run({"time.end=0.4", "body.heat.duration=0.4", "time.step=" + std::to_string(h)})
        .table.at("rod.midpoint_deflection")
        .back();
  };
  const double a = at_end(4e-3), b = at_end(2e-3), c = at_end(1e-3);
  EXPECT_NEAR(std::log2((a - b) / (b - c)), 2, 0.25);
}

// Three integrators (implicit generalized-alpha with index 3, energy-momentum, and explicit minimal
// coordinates as in the paper) compute one motion, the first quarter of the swing. The slider also
// vibrates along the rod with an amplitude of 2e-5 of the rod's length, resolved by 36 steps per
// period; the tolerance of the slider's position allows for a difference in phase.
TEST(SliderCrank, IntegratorsAgree) {
  const auto swing = [](const char* integrator, const char* step) {
    return run({"time.end=0.2", std::string("time.integrator=") + integrator,
                std::string("time.step=") + step, "body.elements=2", "body.heat.duration=0.2"});
  };
  const MotionRecord alpha = swing("generalized_alpha", "2e-4"),
                     momentum = swing("energy_momentum", "2e-4"),
                     minimal = swing("minimal_coordinates", "2e-3");
  const double expected = alpha.table.at("rod.midpoint_deflection").back();
  EXPECT_GT(std::abs(expected), 5e-4);
  for (const MotionRecord* other : {&momentum, &minimal}) {
    EXPECT_NEAR(other->table.at("rod.midpoint_deflection").back() / expected, 1, 2e-3);
    EXPECT_NEAR(other->table.at("rod.slider_x").back(), alpha.table.at("rod.slider_x").back(),
                6e-6);
  }
}

// After a sudden temperature the rod is too short. It vibrates between its pin and the free slider
// with the quarter-wave frequency f = √(E/ρ) / (4 L) = 137 Hz and with strains up to α ΔT.
TEST(SliderCrank, StepOfTheTemperatureRingsAtTheAxialFrequency) {
  const Changes fine = {"time.end=0.1", "time.step=1e-4", "body.heat.duration=1"};
  Changes sudden = fine;
  sudden.push_back("body.heat.profile=step");
  const MotionRecord gradual = run(fine), step = run(sudden);
  const double a = kAlpha * 50;
  EXPECT_GT(largest_size(step.table.at("rod.max_elastic_strain")), 0.9 * a);
  EXPECT_LT(largest_size(gradual.table.at("rod.max_elastic_strain")), 0.3 * a);
  // Counts how often the position of the slider, relative to the gradually heated rod, crosses its
  // mean.
  std::vector<double> u;
  for (size_t k = 0; k < step.time().size(); ++k)
    u.push_back(step.table.at("rod.slider_x")[k] - gradual.table.at("rod.slider_x")[k] -
                kRod * (a - kAlpha * gradual.table.at("rod.temperature")[k]));
  int crossings = 0;
  for (size_t k = 1; k < u.size(); ++k) crossings += (u[k] > 0) != (u[k - 1] > 0);
  const double frequency = std::sqrt(2e8 / 7200) / (4 * kRod);
  // The number of crossings is an integer: 27 and 28 differ by less than one from 2 f times 0.1 s.
  EXPECT_NEAR(crossings / 0.2, frequency, 1 / 0.2);
}

}  // namespace
}  // namespace flexmorph::cases
