#pragma once

#include <span>
#include <vector>

/// Where the load on a path of equilibria turns.
namespace flexmorph::cases {

/// The load factors at which a path turns, in its order: of the parabola through the equilibrium
/// whose load is the largest or smallest of its neighbours', and those, over the length of the
/// path. Where the factor is a smooth function of that, it is off by the third power of the steps.
/// @param arc     length of the path at every equilibrium, grows strictly
/// @param factor  load factors there, as many
std::vector<double> limit_loads(std::span<const double> arc, std::span<const double> factor);

}  // namespace flexmorph::cases
