#pragma once

#include <string>
#include <vector>

#include "cases/run/run_context.h"
#include "cases/run/run_end.h"

namespace flexmorph::cases {

/// Runs a prepared case into its folder, as far as it gets. Status, warnings and expectations of
/// the result are not yet filled. Where memory runs out the error is numerical: the estimate of
/// resource_estimate.h is within a factor.
EndedRun run_prepared(const RunContext& run);

/// Options of the command `run`.
struct RunOptions {
  std::string case_name;               ///< path, or name of a shipped case
  std::string directory;               ///< of the run folder; empty: runs/<name>
  std::vector<std::string> overrides;  ///< KEY=VALUE
  int threads = 1;
  bool quiet = false;
  bool resume = false;     ///< whether a run of the same case in the folder is resumed
  bool explain = false;    ///< whether the folder keeps the case with all its defaults
  bool condition = false;  ///< whether conditions of matrices are estimated at the end
};

/// Runs a case from file to folder. @return exit code: 0 done, 4 interrupted (what was computed is
/// kept), kMissed. @throws Error; a numerical one after the folder says what failed.
int run_case(const RunOptions& options);

}  // namespace flexmorph::cases
