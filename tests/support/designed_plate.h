#pragma once

#include "optim/mmc/cycles/body_design.h"
#include "optim/mmc/loads/compliance_evaluator.h"
#include "tests/optim/mmc_small.h"

/// A designed plate with void, small enough for tests: 60 x 10 cells.
namespace flexmorph::testing {

/// Stiff under a force at its tip, after 60 iterations, half of it void. Made once.
inline const mmc::BodyProblem& designed_plate() {
  static const mmc::BodyProblem made = [] {
    const TdfSettings band = mmc::test::tdf_settings(1.0);
    mmc::BodyProblem problem = mmc::test::body_of(
        mmc::Design(mmc::test::kGrid, mmc::test::layout(), mmc::test::kScale), {band});
    mmc::ComplianceEvaluator tip = mmc::test::tip_load();
    mmc::DesignSettings settings;
    settings.optimizer.max_iterations = 60;
    bool going = true;
    mmc::design_body(problem, tip, 1, settings, {}, going);
    return problem;
  }();
  return made;
}

/// Its factors in a motion: those of its outlines, void as in dynamics.
inline fem::Factors designed_factors() {
  const mmc::BodyProblem& problem = designed_plate();
  return mmc::dynamic_factors(problem, problem.design.components());
}

}  // namespace flexmorph::testing
