#pragma once

#include <span>
#include <vector>

#include "geometry/base.h"

namespace flexmorph::verification {

/// A force and a moment that are spread over points.
struct ForceSpread {
  Vec2 force{0, 0};      ///< in all [N]
  double moment = 0;     ///< in all, counterclockwise, of forces that have no resultant [N m]
  bool bearing = false;  ///< whether the force is that of a pin in a bore
  Vec2 center{0, 0};     ///< of the bore [m]
};

/// Returns the forces at the points [N], one for each.
///
/// Force: even by the shares; of a pin radial, on the half of the rim before it, proportional to
/// the cosine of the angle from the force (n nᵀ a with the normal n, a such that the sum is the
/// force). Moment: as those of a disc that is turned around the weighted middle of the points.
/// @param shares  of the points in an even force (sum 1)
/// @return nothing where points cannot carry it: there is none, a pin has no rim before it that
///         holds it in both directions, a moment has no lever
std::vector<Vec2> spread(const ForceSpread& load, std::span<const Vec2> points,
                         std::span<const double> shares);

}  // namespace flexmorph::verification
