#pragma once

#include "cases/assembly/prepared_case.h"
#include "cases/output/run_folder.h"
#include "cases/run/progress.h"

namespace flexmorph::cases {

/// The case, the folder, the callbacks and the options that all stages of a run share.
struct RunContext {
  const PreparedCase& prepared;  ///< The case that is computed.
  RunFolder* folder;             ///< Folder that receives all files; null means no files.
  Progress& progress;            ///< Display that receives messages and progress.
  std::function<bool()>
      keep_running;        ///< Cancellation callback of steps and iterations; false stops.
  int threads = 1;         ///< Number of motions computed at the same time.
  bool condition = false;  ///< True if conditions of matrices are estimated at the end.
  bool resume = false;     ///< True if the run resumes the run in its folder.
  bool uniform = true;     ///< True if motions with uniform material are computed.

  /// Callback that receives the report of every design iteration, after the iteration is written.
  std::function<void(const mmc::IterationReport&)> iteration{};

  /// Returns the scene of the case.
  const Scene& scene() const { return prepared.scene(); }
};

}  // namespace flexmorph::cases
