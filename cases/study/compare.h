#pragma once

#include "cases/study/study.h"

namespace flexmorph::cases {

struct CompareOptions {
  StudyOptions study;
  std::vector<std::string> optimizers;  ///< empty: all of the table
  int starts = 5;                       ///< the case's own, and this many less one jittered ones
  double jitter = 0.1;                  ///< of those, see design.jitter
  /// State solves of each run. 0: the case's iterations + 1; its own optimizer runs as it does
  /// alone.
  int budget = 0;
};

/// Runs a case with several optimizers from the same starts, under the same stopping measure (KKT
/// residual, feasibility, state solves), and writes compare.csv (a row per run), compare.md (a row
/// per optimizer as well) and compare.svg (convergence over state solves and over time, data
/// profile) into the study's folder; the table goes to the terminal.
/// @return exit code as run_variants(). @throws Error (input).
int compare_case(const CompareOptions& options);

}  // namespace flexmorph::cases
