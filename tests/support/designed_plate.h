#pragma once

#include "optim/mmc/cycles/body_design.h"
#include "optim/mmc/loads/compliance_evaluator.h"
#include "tests/optim/mmc_small.h"

/// A designed plate with void, small enough for tests: 60 x 10 cells.
namespace flexmorph::testing {

/// Returns a plate that was optimized for 60 iterations for a small compliance under a tip force;
/// half of it is void. It is computed once.
inline const mmc::BodyProblem& designed_plate() {
  static const mmc::BodyProblem made = [] {
    const TdfSettings band = mmc::test::tdf_settings(1.0);
    mmc::BodyProblem problem = mmc::test::body_of(
        mmc::Design(mmc::test::kGrid, mmc::test::layout(), mmc::test::kScale), {band});
    mmc::ComplianceEvaluator tip = mmc::test::tip_load();
    mmc::DesignSettings settings;
    settings.optimizer.max_iterations = 60;
    bool is_running = true;
    mmc::design_body(problem, tip, 1, settings, {}, is_running);
    return problem;
  }();
  return made;
}

/// Returns the scale factors of the designed plate in a motion, from its outlines; void cells have
/// the values of the dynamic simulation.
inline fem::ScaleFactors designed_factors() {
  const mmc::BodyProblem& problem = designed_plate();
  return mmc::dynamic_factors(problem, problem.design.components());
}

}  // namespace flexmorph::testing
