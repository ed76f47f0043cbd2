#pragma once

#include <string>
#include <vector>

#include "cases/run/run_context.h"
#include "cases/run/run_end.h"

namespace flexmorph::cases {

/// Computes a prepared case, writes its files, and returns the results up to an error. Status,
/// warnings and expectations of the result are not filled yet. If memory runs out, the error is
/// numerical, because the resource estimate (resource_estimate.h) is only accurate to a factor.
EndedRun run_prepared(const RunContext& run);

/// Options of the command `run`.
struct RunOptions {
  std::string case_name;               ///< Path of a case file, or name of a shipped case.
  std::string directory;               ///< Run folder; empty means runs/<name>.
  std::vector<std::string> overrides;  ///< Overrides of keys of the case, "KEY=VALUE".
  int threads = 1;                     ///< Number of motions computed at the same time.
  bool quiet = false;                  ///< True if only warnings and errors are printed.
  bool resume = false;                 ///< True if a run of the same case in the folder is resumed.
  double seconds = 0;      ///< CPU time after which the run ends as failed [s]; 0: no limit.
  bool open = false;       ///< True if the page of the run is opened in a browser at its start.
  bool explain = false;    ///< True if the folder receives the case with all its defaults.
  bool condition = false;  ///< True if conditions of matrices are estimated at the end.
};

/// Returns the command that resumes an interrupted run, for the screen: words that a shell reads,
/// on lines that are not longer than the screen is wide unless a word is.
std::string resume_command(const RunOptions& options);

/// Runs a case, from its file to its run folder.
/// @return exit code: 0 for a complete run, 4 for an interrupted run (its results so far are
///         written), or kExpectationsMissed
/// @throws Error; a numerical one is thrown after the failure is written into the folder
int run_case(const RunOptions& options);

}  // namespace flexmorph::cases
