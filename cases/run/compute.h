#pragma once

#include <functional>
#include <span>
#include <string>

#include "cases/check/ready.h"
#include "cases/results/run_result.h"

/// Functions for programs that load and compute cases without a run folder and without output on
/// the terminal.
namespace flexmorph::cases {

/// Loads a case and builds the objects that a run of it needs first.
/// @param name     path of a case file, or name of a shipped case
/// @param changes  overrides of keys, "KEY=VALUE", as after --set
/// @throws Error (input) naming file, line and key; Error (numerical) where a trajectory cannot be
///         reached
PreparedCase load_case(const std::string& name, std::span<const std::string> changes = {});

/// Settings of a computation without a run folder. Empty functions are not called.
struct ComputeSettings {
  int threads = 1;  ///< Number of motions that are computed at the same time.

  /// Cancellation callback; it is called at every step and iteration, and false stops the run.
  std::function<bool()> keep_running;

  /// Callback that receives the messages which a run prints on the terminal.
  std::function<void(const std::string&)> say;

  /// Callback that receives the report of every design iteration.
  std::function<void(const mmc::IterationReport&)> iteration;
};

/// Computes a case with the same numbers as the command `run` and writes no file. The result is
/// complete: it contains the status, the warnings and the compared expectations.
/// @throws the Error of the run; Interrupted
RunResult compute(const PreparedCase& prepared, const ComputeSettings& settings = {});

/// Computes a case with the files that the command `run` writes into its run folder. It prints
/// nothing and installs no handlers of signals.
/// @param ready      case with its file, which the folder keeps
/// @param directory  run folder; an earlier run in it is moved as a whole
/// @param resume     true if a run of the same case in the folder is resumed
/// @return exit code of the command: 0 for a complete run; 4 if `keep_running` ended it; 5 if it
///         violates an expectation of the case or is not usable. The results so far are written.
/// @throws the Error of the run, after it is written into the folder
int compute_into(const ReadyCase& ready, const std::string& directory,
                 const ComputeSettings& settings = {}, bool resume = false);

/// Computes a case as compute() does, and returns the results computed before an error together
/// with the error.
EndedRun compute_as_far_as_possible(const PreparedCase& prepared,
                                    const ComputeSettings& settings = {});

}  // namespace flexmorph::cases
