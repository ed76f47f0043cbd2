#pragma once

#include <functional>
#include <span>
#include <string>

#include "cases/assembly/prepared_case.h"
#include "cases/results/run_result.h"

/// Cases for programs: loaded and computed without a run folder and without the screen.
namespace flexmorph::cases {

/// Loads a case and builds what a run of it builds first.
/// @param name     path of a case file, or name of a shipped case
/// @param changes  KEY=VALUE, as after --set
/// @throws Error (input) naming file, line and key; Error (numerical) where a trajectory cannot be
///         reached
PreparedCase load_case(const std::string& name, std::span<const std::string> changes = {});

/// Settings of a computation without a run folder. Empty functions are not called.
struct ComputeSettings {
  int threads = 1;              ///< motions that are computed at the same time
  std::function<bool()> go_on;  ///< asked at every step and iteration; false interrupts
  std::function<void(const std::string&)> say;  ///< told what a run says on the screen
  std::function<void(const mmc::IterationReport&)> iteration;  ///< told every design iteration
};

/// Computes a case as the command `run` does, with the same numbers, and writes no file. The result
/// is complete, with status, warnings and expectations.
/// @throws the Error of the run; Interrupted
RunResult compute(const PreparedCase& prepared, const ComputeSettings& settings = {});

/// Computes a case as compute() does, and returns what was computed before an error together with
/// the error.
EndedRun compute_as_far_as_possible(const PreparedCase& prepared,
                                    const ComputeSettings& settings = {});

}  // namespace flexmorph::cases
