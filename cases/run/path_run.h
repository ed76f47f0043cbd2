#pragma once

#include <functional>

#include "cases/run/run_folder.h"

namespace flexmorph::cases {

/// Follows the equilibria of a [static] analysis from load factor 0.
/// @param folder  receives path.csv, and with output.vtk a frame per equilibrium
/// @param go_on   asked at every equilibrium; false ends it with Interrupted
/// @param condition  estimate it at the end
/// @throws Error (numerical) or Interrupted, with the equilibria before it in the table
PathRecord run_path(const Scene& scene, RunFolder& folder, const std::function<bool()>& go_on,
                    bool condition = false);

}  // namespace flexmorph::cases
