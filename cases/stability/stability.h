#pragma once

#include <string>
#include <vector>

#include "cases/stability/judge.h"

namespace flexmorph::cases {

struct StabilityOptions {
  std::vector<std::string> cases;      ///< files or names; empty: all shipped ones
  std::vector<std::string> suites;     ///< names; empty: all that do not run on request only
  std::vector<std::string> overrides;  ///< KEY=VALUE of all cases
  std::string directory;               ///< empty: runs/stability
  int jobs = 1;                        ///< processes at a time
  double timeout = 60;                 ///< CPU time of a row [s]
  bool quiet = false;                  ///< the summary alone
};

/// One row of one case, and what became of it.
struct StabilityRow {
  std::string case_name, suite;
  Perturbation perturbation;
  Ending ending;
  bool ran = false;  ///< false: the check was interrupted before
  Judgement judgement;
};

/// Runs the suites on cases, every row in a process of its own with limits of time and memory, and
/// judges what became of them. Leaves stability.csv, .md and .svg in the folder, written anew after
/// every tenth row, so that an interrupted check keeps what it has, with a run folder per row below
/// it; rows that ended before, with the very same case, are judged again from what
/// they left but not run again.
/// @return exit code: 0, 3 when a row is WRONG, 4 when interrupted
/// @throws Error (input) for a case or suite that is not there, or a case that is refused as it is.
int check_stability(const StabilityOptions& options);

}  // namespace flexmorph::cases
