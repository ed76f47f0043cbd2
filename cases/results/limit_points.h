#pragma once

#include <span>
#include <vector>

/// Limit points of a path of equilibria, at which the load factor has a local extremum.
namespace flexmorph::cases {

/// Returns the load factors at the limit points of a path, in the order of the path. A limit load
/// is the extremum of the parabola through three neighbouring equilibria, of which the middle one
/// has the largest or the smallest load factor; the abscissa is the arc length. If the load factor
/// is a smooth function of the arc length, the error is of third order in the steps.
/// @param arc     arc length at every equilibrium (n), strictly increasing
/// @param factor  load factor at every equilibrium (n)
std::vector<double> limit_loads(std::span<const double> arc, std::span<const double> factor);

}  // namespace flexmorph::cases
