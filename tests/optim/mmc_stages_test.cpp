// Shows when a stage of the design ends: at a plateau of the objective, or only with its share of
// the iterations if no criterion of stagnation is wanted.

#include <gtest/gtest.h>

#include "optim/mmc/cycles/body_design.h"
#include "optim/mmc/loads/compliance_evaluator.h"
#include "tests/optim/mmc_small.h"

namespace flexmorph::mmc::test {
namespace {

/// Returns the number of iterations of a design that hardly moves: a feasible start, steps of 1e-9.
/// @param rows  rows over which stagnation is tested, see optim::StoppingWindow
int iterations_of_a_slow_design(int rows) {
  BodyProblem problem =
      body_of(Design(kGrid, layout(), kScale), {tdf_settings(1.0)}, least_compliance(0.9));
  ComplianceEvaluator tip = tip_load();
  DesignSettings settings;
  settings.optimizer.max_iterations = 50;
  settings.optimizer.move_limit = 1e-9;
  settings.optimizer.rest = {rows, 1e-3, 1e-12};
  bool is_running = true;
  return design_body(problem, tip, 1, settings, {}, is_running).iterations;
}

TEST(Stages, EndAtAPlateauOnlyWithACriterionOfStagnation) {
  EXPECT_EQ(iterations_of_a_slow_design(15), optim::Verdict::kPlateauRows + 1);
  EXPECT_EQ(iterations_of_a_slow_design(0), 50);
}

}  // namespace
}  // namespace flexmorph::mmc::test
