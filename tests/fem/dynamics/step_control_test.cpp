// Shows that the estimate of the local error is the local error in motions that the step resolves,
// that components which the step does not resolve do not count, and that the controller attains its
// target error.
#include "fem/dynamics/integrators/step_control.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>

#include "fem/dynamics/integrators/energy_momentum.h"
#include "fem/dynamics/integrators/generalized_alpha.h"
#include "tests/support/oscillators.h"
#include "tests/support/particle_pendulum.h"
#include "tests/support/rates.h"

namespace flexmorph::fem {
namespace {

using testing::exact_swing;
using testing::Oscillators;

constexpr double kUnlimited = 1e300;  // an allowed error that accepts every step

AlphaSettings crisp(double rho_inf) {
  AlphaSettings settings;
  settings.rho_inf = rho_inf;
  settings.tolerance = 1e-14;
  return settings;
}

struct Missed {
  double estimate = 0, exact = 0;
  double ratio() const { return estimate / exact; }
};

/// Returns the error of one step from the exact motion with the algorithmic acceleration q̈(t + δ
/// h).
Missed miss_of_oscillator(double rho_inf, double omega, double h, double t = 0.3) {
  const Oscillators exact{{omega, omega}};
  Workspace model = exact.model();
  GeneralizedAlpha alpha(model, crisp(rho_inf));
  State x = exact.at(t);
  alpha.set_alpha(exact.at(t + alpha.shift() * h).a);
  const TriedStep step = alpha.try_step(x, h, kUnlimited);
  EXPECT_TRUE(step.converged);
  // The size of this model is 1 m.
  return {step.error, (x.q - exact.at(t + h).q).lpNorm<Eigen::Infinity>()};
}

Missed miss_of_pendulum(double rho_inf, double h) {
  constexpr double t = 0.4;
  Workspace model = testing::particle_pendulum();
  GeneralizedAlpha alpha(model, crisp(rho_inf));
  const auto acceleration = [](double at) -> Vec2 {
    const testing::Swing s = exact_swing(at);
    const double spin = -testing::kGravity / testing::kLength * std::sin(s.angle);
    return testing::kLength * (spin * Vec2(std::cos(s.angle), std::sin(s.angle)) -
                               s.rate * s.rate * Vec2(std::sin(s.angle), -std::cos(s.angle)));
  };
  State x = model.reference();
  x.t = t;
  x.q.head<2>() = exact_swing(t).position();
  x.v.head<2>() = exact_swing(t).velocity();
  x.a.head<2>() = acceleration(t);
  x.lambda = VectorXd::Constant(1, exact_swing(t).lambda());
  VectorXd shifted = VectorXd::Zero(x.a.size());
  shifted.head<2>() = acceleration(t + alpha.shift() * h);
  alpha.set_alpha(shifted);
  const TriedStep step = alpha.try_step(x, h, kUnlimited);
  return {step.error,
          (x.q - exact_swing(t + h).position()).lpNorm<Eigen::Infinity>() / testing::kLength};
}

class LocalError : public ::testing::TestWithParam<double> {};
// For each of these values δ h is a multiple of the step of the pendulum's table.
INSTANTIATE_TEST_SUITE_P(RhoInf, LocalError, ::testing::Values(0.0, 0.5, 0.8, 1.0),
                         [](const auto& rho) {
                           return "rho" +
                                  std::to_string(static_cast<int>(std::lround(100 * rho.param)));
                         });

TEST_P(LocalError, ConstantIsThatOfTheExpansion) {
  Workspace model = testing::particle_pendulum();
  const GeneralizedAlpha alpha(model, crisp(GetParam()));
  const double shift = (GetParam() - 1) / (GetParam() + 1);
  EXPECT_NEAR(alpha.shift(), shift, 1e-15);
  EXPECT_NEAR(alpha.error_constant(), -(1.0 / 12 + shift * shift / 4), 1e-15);
}

// Estimate / error = 1 + O(h); the distance from one halves with h.
TEST_P(LocalError, OfAnOscillatorIsEstimated) {
  std::vector<double> off;
  for (const double h : {0.02, 0.01, 0.005}) {
    const Missed m = miss_of_oscillator(GetParam(), 3, h);
    std::printf("h = %.3f: error %.3e, estimate %.3e, ratio %.4f\n", h, m.exact, m.estimate,
                m.ratio());
    off.push_back(std::abs(m.ratio() - 1));
  }
  EXPECT_LT(off.back(), 0.05);
  EXPECT_NEAR(off[1] / off[2], 2, 0.5);
}

TEST_P(LocalError, OfAPendulumIsEstimated) {
  std::vector<double> off;
  for (const double h : {0.036, 0.018, 0.009}) {
    const Missed m = miss_of_pendulum(GetParam(), h);
    std::printf("h = %.4f: error %.3e, estimate %.3e, ratio %.4f\n", h, m.exact, m.estimate,
                m.ratio());
    off.push_back(std::abs(m.ratio() - 1));
  }
  EXPECT_LT(off.back(), 0.15);
  EXPECT_NEAR(off[1] / off[2], 2, 0.7);
}

/// Returns the number of steps over 2 s of oscillators with the step control.
int steps_over(const Oscillators& exact, double tolerance, double* error = nullptr) {
  Workspace model = exact.model();
  GeneralizedAlpha alpha(model, crisp(0.8));
  AdaptiveStep settings;
  settings.tolerance = tolerance;
  StepControl control(settings, 2);
  State x = exact.at(0);
  control.begin(alpha.first_step(x, control.allowed(), control.largest()));
  while (x.t < 2) {
    const double left = 2 - x.t, h = control.next(left), start = x.t;
    const TriedStep step = alpha.try_step(x, h, control.allowed());
    if (step.error > control.allowed()) {
      control.rejected(h, step.error, start);
      continue;
    }
    control.accepted(h, step.error, step.iterations);
    if (h == left) x.t = 2;
    if (error) *error = std::max(*error, (x.q - exact.at(x.t).q).lpNorm<Eigen::Infinity>());
  }
  return alpha.counts().steps;
}

// The second oscillator, at 480 Hz, has an amplitude below the tolerance: the steps need not
// resolve it.
TEST(Filter, ForgetsWhatTheStepDoesNotResolve) {
  for (const double tolerance : {1e-3, 1e-4}) {
    const int slow = steps_over({{3, 3}}, tolerance);
    double error = 0;
    const int both = steps_over({{3, 3000}, {1, 0.03 * tolerance}}, tolerance, &error);
    std::printf("tolerance %.0e: %d steps alone, %d with 480 Hz; error %.2e m\n", tolerance, slow,
                both, error);
    EXPECT_LT(both, 1.3 * slow);
    EXPECT_LT(error, 10 * tolerance);
  }
}

// A second oscillator at the limit of the resolved frequencies has a tenth of the tolerance as
// amplitude.
TEST(Filter, DoesNotFollowWhatIsBelowTheTolerance) {
  for (const double tolerance : {1e-4, 1e-5}) {
    const int slow = steps_over({{3, 3}}, tolerance);
    double error = 0;
    const double omega = 2.5 * slow / 2;  // two and a half radians in a step
    const int both = steps_over({{3, omega}, {1, 0.1 * tolerance}}, tolerance, &error);
    std::printf("tolerance %.0e: %d steps alone, %d with %.0f rad/s; error %.2e m\n", tolerance,
                slow, both, omega, error);
    EXPECT_LT(both, 1.3 * slow);
    EXPECT_LT(error, 10 * tolerance);
  }
}

TEST(StepControl, LandsWithTwoEqualSteps) {
  AdaptiveStep settings;
  settings.largest = 0.3;
  StepControl control(settings, 1);
  control.begin(1);
  EXPECT_EQ(control.next(1), 0.3);
  EXPECT_EQ(control.next(0.5), 0.25);
  EXPECT_EQ(control.next(0.25), 0.25);
  EXPECT_EQ(control.next(0.3001), 0.3001);  // avoids another step of 0.1 ms
  EXPECT_DOUBLE_EQ(control.allowed(), 1e-6);
}

// With errors ∝ h³ the step converges to a value below the allowed error and is then constant to
// the bit.
TEST(StepControl, SettlesBelowTheAllowedError) {
  StepControl control({}, 100);
  control.begin(1e-3);
  double h = 0;
  const double best = 0.05;  // has the allowed error
  int rejected = 0, changes = 0;
  for (int k = 0; k < 60; ++k) {
    const double last = h;
    h = control.next(100);
    const double error = control.allowed() * std::pow(h / best, 3);
    changes += k > 30 && h != last;
    if (error > control.allowed()) {
      control.rejected(h, error, 0);
      ++rejected;
    } else {
      control.accepted(h, error, 3);
    }
  }
  EXPECT_LE(rejected, 1);
  EXPECT_EQ(changes, 0);
  EXPECT_GT(h, 0.7 * best);
  EXPECT_LE(h, best);
}

TEST(StepControl, StaysWhereNewtonManages) {
  StepControl control({}, 100);
  control.begin(0.8);
  control.failed(0.8, 0);
  for (int k = 0; k < 15; ++k) {
    const double h = control.next(100);
    EXPECT_LT(h, 0.8);
    control.accepted(h, 0, 3);
  }
  for (int k = 0; k < 20; ++k) control.accepted(control.next(100), 0, 3);
  EXPECT_GT(control.next(100), 0.8);
  const double h = control.next(100);
  control.accepted(h, 0, 8);
  EXPECT_EQ(control.next(100), h);
  control.accepted(h, 0, 11);
  EXPECT_LT(control.next(100), 0.8 * h);
}

TEST(StepControl, SaysWhatItCannotDo) {
  AdaptiveStep settings;
  settings.smallest = 1e-3;
  StepControl control(settings, 1);
  control.begin(2e-3);
  try {
    control.rejected(2e-3, std::nan(""), 0.25);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), Error::Kind::numerical);
    const std::string text = error.what();
    for (const char* part : {"t = 0.25 s", "local error"})
      EXPECT_NE(text.find(part), std::string::npos) << text;
  }
  for (const double bad : {0.0, 1.0, -1.0, std::nan("")}) {
    AdaptiveStep wrong;
    wrong.tolerance = bad;
    EXPECT_THROW(StepControl(wrong, 1), Error) << bad;
  }
  AdaptiveStep crossed;
  crossed.smallest = 0.2;
  crossed.largest = 0.1;
  EXPECT_THROW(StepControl(crossed, 1), Error);
}

TEST(TryStep, IsRefusedWithoutAnEstimate) {
  const Oscillators exact{{3, 3}};
  Workspace model = exact.model();
  EnergyMomentum scheme(model, {});
  State x = exact.at(0);
  EXPECT_THROW(scheme.try_step(x, 0.01, 1), Error);
}

}  // namespace
}  // namespace flexmorph::fem
