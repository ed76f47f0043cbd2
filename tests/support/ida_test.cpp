// Shows that the reference integrator IDA follows a pendulum whose motion is known: position,
// velocity and force in the rod.
#include "tests/support/ida.h"

#include <gtest/gtest.h>

#include <iostream>

#include "fem/dynamics/integrators/generalized_alpha.h"
#include "tests/support/errors.h"
#include "tests/support/particle_pendulum.h"

namespace flexmorph::testing {
namespace {

struct Swung {
  double q = 0, v = 0, lambda = 0;  // largest errors
  IdaCounts counts;
};

Swung swing(double tolerance) {
  fem::Workspace model = particle_pendulum();
  fem::State x = swing_start(model);
  fem::GeneralizedAlpha(model, {}).make_consistent(x);
  IdaSettings settings;
  settings.tolerance = tolerance;
  settings.speed = 5;
  const std::vector<double> times = {0.5, 1, 1.5, 2};
  Swung out;
  for (const fem::State& at : solve_by_ida(model, x, times, settings, &out.counts)) {
    const Swing s = exact_swing(at.t);
    out.q = std::max(out.q, (at.q - s.position()).norm());
    out.v = std::max(out.v, (at.v - s.velocity()).norm());
    out.lambda = std::max(out.lambda, std::abs(at.lambda[0] - s.lambda()));
  }
  return out;
}

// Global errors accumulate over some hundred steps and are proportional to the tolerance. A
// multiplier changes the momentum within one step; therefore its error may be the velocity error
// divided by the step length.
TEST(Ida, FollowsAPendulumAsItsToleranceSays) {
  for (const double tolerance : {1e-6, 1e-8, 1e-10}) {
    const Swung e = swing(tolerance);
    std::cout << "tolerance " << tolerance << ": " << e.counts.steps << " steps, order "
              << e.counts.order << ", errors " << e.q << " m, " << e.v << " m/s, " << e.lambda
              << " N/m\n";
    EXPECT_LT(e.q, 300 * tolerance);
    EXPECT_LT(e.v, 1500 * tolerance);
    EXPECT_LT(e.lambda, kMass * e.v * static_cast<double>(e.counts.steps) / 2);
  }
}

TEST(Ida, SaysWhenItGivesUp) {
  fem::Workspace model = particle_pendulum();
  fem::State x = swing_start(model);
  fem::GeneralizedAlpha(model, {}).make_consistent(x);
  IdaSettings settings;
  settings.max_steps = 5;
  const double times[] = {2.0};
  EXPECT_TRUE(
      mentions(error_of(Error::Kind::numerical, [&] { solve_by_ida(model, x, times, settings); }),
               "IDASolve"));
}

}  // namespace
}  // namespace flexmorph::testing
