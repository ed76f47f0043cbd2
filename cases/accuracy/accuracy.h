#pragma once

#include "cases/study/study.h"

namespace flexmorph::cases {

/// Options of the command `accuracy`.
struct AccuracyOptions {
  StudyOptions study;           ///< Options of the study.
  std::string budget = "120s";  ///< CPU time of all runs, see read_duration().

  /// Names of discretization parameters; empty means the parameters that the case names, or all.
  std::vector<std::string> refinements;

  bool verify = true;  ///< True if recommended settings are verified by runs within the budget.
};

/// Measures the error and the run time of a case for refinement series of its discretization
/// parameters. It extrapolates the limits of the series and determines the cheapest settings for
/// errors of 1 %, 0.1 % and 0.01 %. Writes accuracy.csv, .md, .svg and CASE_1pct.toml ... into the
/// folder of the study and prints the tables. Every level is a run of this program in a folder of
/// its own; the runs are sequential, and finished runs are not repeated. A level that fails is
/// reported as a result.
/// @return exit code: 0, or 4 if interrupted (the measured levels are kept)
/// @throws Error (input) for a case that is refused, or for a case without a quantity of interest
///         (the message names the existing quantities); Error (numerical) if the unchanged case
///         fails
int accuracy_case(const AccuracyOptions& options);

}  // namespace flexmorph::cases
