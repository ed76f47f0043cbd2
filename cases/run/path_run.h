#pragma once

#include <functional>

#include "cases/assembly/prepared_case.h"
#include "cases/output/run_folder.h"
#include "cases/results/motion_record.h"

namespace flexmorph::cases {

/// Settings of a run along a path of equilibria.
struct PathRequest {
  bool condition = false;               ///< whether the condition of the last matrix is estimated
  std::function<bool()> go_on;          ///< asked at every equilibrium; false interrupts
  std::function<void(double)> reached;  ///< told the load factor of every equilibrium
};

/// Follows the equilibria of a [static] analysis from load factor 0.
/// @param folder  receives path.csv, and with output.vtk a frame per equilibrium
/// @throws FailedRun or Interrupted, with the equilibria before it in the table
PathRecord run_path(const PreparedCase& prepared, RunFolder& folder, const PathRequest& request);

}  // namespace flexmorph::cases
