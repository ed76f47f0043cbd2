#pragma once

#include "cases/study/study.h"

namespace flexmorph::cases {

/// Options of the command `compare` for optimizers.
struct CompareOptions {
  StudyOptions study;                   ///< Options of the study.
  std::vector<std::string> optimizers;  ///< Names of the optimizers; empty means all.
  int starts = 5;       ///< Number of starts: the start of the case, all others with jitter.
  double jitter = 0.1;  ///< Jitter of the starts, see design.jitter [-].

  /// Number of state solves of each run. 0 means the iterations of the case + 1, and that the
  /// optimizer of the case runs with the settings of the case.
  int budget = 0;
};

/// Runs a case with several optimizers from the same starts, under the same stopping criteria (KKT
/// residual, feasibility, state solves). Writes compare.csv (a row per run), compare.md (with a row
/// per optimizer) and compare.svg (convergence over state solves and over time, data profiles) into
/// the folder of the study, and prints the table per optimizer on the terminal.
/// @return exit code as run_variants()
/// @throws Error (input) for options or a case that cannot be used
int compare_case(const CompareOptions& options);

}  // namespace flexmorph::cases
