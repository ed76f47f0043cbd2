#pragma once

#include "cases/accuracy/study.h"

namespace flexmorph::cases {

struct AccuracyOptions {
  StudyOptions study;
  std::string budget = "120s";       ///< CPU time of all runs, see read_budget()
  std::vector<std::string> ladders;  ///< names of knobs; empty: as the case says, or all
  bool verify = true;                ///< run what is recommended, where the budget allows
};

/// Error against run time of a case: ladders over its knobs, limits by extrapolation, and the
/// cheapest settings for 1 %, 0.1 % and 0.01 %. Leaves accuracy.csv, .md, .svg and CASE_1pct.toml
/// ... in the study's folder; tables go to the terminal. Levels are runs of this very program, one
/// after the other, in folders of their own below it; those that are finished are not run again.
/// @return exit code: 0, 4 when interrupted (what was measured is kept)
/// @throws Error (input) for a case that is refused, or without a quantity, naming those there are;
///         Error (numerical) when the case itself fails. A level that fails is a finding.
int accuracy_case(const AccuracyOptions& options);

}  // namespace flexmorph::cases
