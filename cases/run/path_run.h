#pragma once

#include <functional>

#include "cases/assembly/prepared_case.h"
#include "cases/output/run_folder.h"
#include "cases/results/run_result.h"

namespace flexmorph::cases {

/// Settings of a run along a path of equilibria.
struct PathRequest {
  bool condition = false;              ///< True if the condition of the last matrix is estimated.
  std::function<bool()> keep_running;  ///< Cancellation callback of every equilibrium; false stops.
  std::function<void(double)> reached;  ///< Callback with the load factor of every equilibrium.

  /// Receives the rows of a path that fails or is interrupted; null means they are discarded.
  std::optional<PathRecord>* unfinished = nullptr;
};

/// Follows the equilibria of a [static] analysis from load factor 0.
/// @param folder  receives path.csv, and with output.vtk a frame per equilibrium; null means that
///                nothing is written
/// @throws FailedRun or Interrupted; the equilibria before are in the table
PathRecord run_path(const PreparedCase& prepared, const PathRequest& request,
                    RunFolder* folder = nullptr);

}  // namespace flexmorph::cases
