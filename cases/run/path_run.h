#pragma once

#include <functional>

#include "cases/output/run_folder.h"

namespace flexmorph::cases {

/// What a path is asked.
struct PathWishes {
  bool condition = false;           ///< estimate it at the end
  std::function<bool()> go_on;      ///< asked at every equilibrium; false ends it with Interrupted
  std::function<void(double)> way;  ///< told the load factor of every equilibrium
};

/// Follows the equilibria of a [static] analysis from load factor 0.
/// @param folder  receives path.csv, and with output.vtk a frame per equilibrium
/// @throws FailedRun or Interrupted, with the equilibria before it in the table
PathRecord run_path(const Scene& scene, RunFolder& folder, const PathWishes& wishes);

}  // namespace flexmorph::cases
