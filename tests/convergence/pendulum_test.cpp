// Shows the order of generalized-alpha on a pendulum in Cartesian coordinates (index 3) whose
// motion is known: 2 in position, velocity and multiplier at the end; a start-up transient of order
// 1 in the largest error of the multiplier; a drift of the velocity constraint that remains of
// order 2. Shows also that the tangent of a joint whose Φ_q depends on q does not change the
// solution and saves iterations.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "fem/dynamics/integrators/generalized_alpha.h"
#include "tests/support/particle_pendulum.h"
#include "tests/support/rates.h"

namespace flexmorph::fem {
namespace {

using testing::exact_swing;
using testing::Swing;

constexpr double kEnd = 2;

struct Errors {
  double q = 0, v = 0, lambda = 0;  // errors at the end
  // largest over the run; drift in its second half
  double largest_lambda = 0, drift = 0, late_drift = 0;
  StepCounts counts;
};

Errors run(double h, double rho_inf, bool exact_tangent = true, AlphaSettings settings = {}) {
  Workspace model = testing::particle_pendulum(exact_tangent);
  settings.rho_inf = rho_inf;
  // Errors of Newton's method divided by h^2 affect the multiplier; with this tolerance they are
  // below its own error at 1 ms.
  settings.tolerance = 1e-14;
  GeneralizedAlpha alpha(model, settings);
  State x = testing::swing_start(model);
  alpha.make_consistent(x);
  Errors e;
  EXPECT_NEAR(x.lambda[0], exact_swing(0).lambda(), 1e-12);
  const int n = static_cast<int>(std::lround(kEnd / h));
  for (int k = 1; k <= n; ++k)
    alpha.advance(x, kEnd * k / n, [&](const State& y) {
      const Swing s = exact_swing(y.t);
      e.q = (y.q - s.position()).norm();
      e.v = (y.v - s.velocity()).norm();
      e.lambda = std::abs(y.lambda[0] - s.lambda());
      e.largest_lambda = std::max(e.largest_lambda, e.lambda);
      const double drift = std::abs(y.q.dot(y.v));
      e.drift = std::max(e.drift, drift);
      if (2 * k > n) e.late_drift = std::max(e.late_drift, drift);
    });
  e.counts = alpha.counts();
  return e;
}

const std::vector<double> kSteps = {8e-3, 4e-3, 2e-3, 1e-3};

class Pendulum : public ::testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(RhoInf, Pendulum, ::testing::Values(0.0, 0.6, 0.8, 0.9),
                         [](const auto& rho) {
                           return "rho" +
                                  std::to_string(static_cast<int>(std::lround(100 * rho.param)));
                         });

// These orders are proved in Arnold & Brüls (2007).
TEST_P(Pendulum, ConvergesWithOrderTwoInPositionVelocityAndMultiplier) {
  for (const auto& [name, value] :
       {std::pair{"q", &Errors::q}, {"v", &Errors::v}, {"lambda", &Errors::lambda}}) {
    const auto rate =
        testing::fit_rate(kSteps, [&](double h) { return run(h, GetParam()).*value; });
    std::cout << name << '\n' << rate.table();
    EXPECT_NEAR(rate.order(), 2, 0.1) << name << '\n' << rate.table();
  }
}

// The initial algorithmic acceleration is q̈(0); the value consistent with the scheme differs by
// O(h), which affects the first multipliers and is damped for rho_inf < 1.
TEST_P(Pendulum, LargestMultiplierErrorIsAStartUpTransient) {
  const auto rate =
      testing::fit_rate(kSteps, [&](double h) { return run(h, GetParam()).largest_lambda; });
  std::cout << "largest lambda error\n" << rate.table();
  EXPECT_GT(rate.order(), 0.9) << rate.table();
}

TEST_P(Pendulum, VelocityDriftIsBoundedAndOfOrderTwo) {
  const auto rate = testing::fit_rate(kSteps, [&](double h) { return run(h, GetParam()).drift; });
  std::cout << "velocity drift\n" << rate.table();
  EXPECT_NEAR(rate.order(), 2, 0.15) << rate.table();
  const Errors e = run(2e-3, GetParam());
  EXPECT_LT(e.late_drift, 1.5 * e.drift);  // it does not grow with time
}

// Without damping at infinite frequency (rho_inf = 1) the index-3 multiplier is only weakly stable:
// position and velocity keep their order, the multiplier does not converge. This is a known limit
// of the method, which should not be used with constraints.
TEST(Pendulum, WithoutDampingOnlyPositionAndVelocityConverge) {
  for (const auto& [name, value] : {std::pair{"q", &Errors::q}, {"v", &Errors::v}}) {
    const auto rate = testing::fit_rate(kSteps, [&](double h) { return run(h, 1).*value; });
    EXPECT_NEAR(rate.order(), 2, 0.1) << name << '\n' << rate.table();
  }
  std::cout << "rho_inf = 1: error of lambda " << run(4e-3, 1).lambda << " of "
            << exact_swing(kEnd).lambda() << " N/m\n";
}

// With and without (Φ_qᵀ λ)_q Newton's method finds the same solution; the exact tangent never
// needs more iterations.
TEST(NonlinearJoint, TangentOfTheConstraintForceChangesTheWayNotTheAnswer) {
  for (const double h : {8e-3, 4e-2}) {
    const Errors with = run(h, 0.8), without = run(h, 0.8, false);
    std::cout << "h = " << h << ": Newton with " << with.counts.newton << " ("
              << with.counts.factorizations << " factors), without " << without.counts.newton
              << " (" << without.counts.factorizations << ")\n";
    EXPECT_LE(with.counts.newton, without.counts.newton);
    EXPECT_EQ(with.counts.rejected + without.counts.rejected, 0);
    EXPECT_NEAR(with.q, without.q, 1e-8);
  }
}

// A step for which Newton's method does not converge within its iterations is halved; later steps
// grow again.
TEST(StepHalving, RecoversAndReportsWhatItCannotDo) {
  AlphaSettings settings;
  settings.max_iterations = 4;
  const Errors e = run(0.1, 0.8, true, settings);
  std::cout << "0.1 s with 4 iterations: " << e.counts.rejected << " rejected, " << e.counts.steps
            << " steps\n";
  EXPECT_GT(e.counts.rejected, 0);
  EXPECT_GT(e.counts.steps, 20);
  EXPECT_LT(e.q, 0.5);  // of order h^2, with h of 0.1 s at most

  settings.max_iterations = 1;
  settings.max_halvings = 3;
  try {
    run(0.1, 0.8, true, settings);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), Error::Kind::numerical);
    const std::string text = error.what();
    for (const char* part : {"converge", "t = 0 s", "1: |r|"})
      EXPECT_NE(text.find(part), std::string::npos) << text;
  }
  EXPECT_THROW(run(0.1, 1.2), Error);
}

}  // namespace
}  // namespace flexmorph::fem
