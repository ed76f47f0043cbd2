#pragma once

#include "cases/study/study.h"

namespace flexmorph::cases {

struct AccuracyOptions {
  StudyOptions study;
  std::string budget = "120s";       ///< CPU time of all runs, see read_budget()
  std::vector<std::string> ladders;  ///< names of parameters; empty: as the case says, or all
  bool verify = true;                ///< run what is recommended, where the budget allows
};

/// Returns the seconds of "120s", "2min", "1.5h", or of a number of seconds.
/// @throws Error (input) for other texts.
double read_budget(const std::string& text);

/// Measures error against run time of a case: refinement series of its parameters, their limits by
/// extrapolation, and the cheapest settings for 1 %, 0.1 % and 0.01 %. Writes accuracy.csv, .md,
/// .svg and CASE_1pct.toml ... in the study's folder and prints the tables. Levels are runs of this
/// program, one after the other, in folders of their own; finished ones are not run again.
/// @return exit code: 0, 4 when interrupted (what was measured is kept)
/// @throws Error (input) for a case that is refused, or without a quantity, naming those there are;
///         Error (numerical) when the case itself fails. A level that fails is a finding.
int accuracy_case(const AccuracyOptions& options);

}  // namespace flexmorph::cases
