#pragma once

#include <functional>
#include <span>
#include <string>

#include "cases/assembly/prepared_case.h"
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

/// Computes a case as compute() does, and returns the results computed before an error together
/// with the error.
EndedRun compute_as_far_as_possible(const PreparedCase& prepared,
                                    const ComputeSettings& settings = {});

}  // namespace flexmorph::cases
