#pragma once

#include <string>
#include <vector>

#include "cases/check/ready.h"

namespace flexmorph::cases {

struct RunOptions {
  std::string case_name;               ///< path, or name of a shipped case
  std::string directory;               ///< of the run folder; empty: runs/<name>
  std::vector<std::string> overrides;  ///< KEY=VALUE
  int threads = 1;
  bool quiet = false;
  bool resume = false;     ///< go on with a run of the same case in the folder
  bool explain = false;    ///< the case with all its defaults: printed by check, kept by run
  bool condition = false;  ///< estimate the conditions of matrices at the end, for run.json
};

/// Exit code of a run that is whole, but misses an expectation of its case or is of no use.
inline constexpr int kMissed = 5;

/// Runs a case from file to folder. @return exit code: 0 done, 4 interrupted (what was computed is
/// kept), kMissed. @throws Error; a numerical one after the folder says what failed.
int run_case(const RunOptions& options);

/// Says what a case contains, what it leaves out, and what each part costs.
/// @throws Error (input) when the case cannot be used.
std::string check_case(const RunOptions& options);

}  // namespace flexmorph::cases
