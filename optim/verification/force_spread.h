#pragma once

#include <span>
#include <vector>

#include "geometry/base.h"

namespace flexmorph::verification {

/// A force and a moment that are distributed over points.
struct ForceSpread {
  Vec2 force{0, 0};      ///< Resultant force [N].
  double moment = 0;     ///< Additional moment, counterclockwise, without a resultant force [N m].
  bool bearing = false;  ///< True if a pin in a bore exerts the force.
  Vec2 center{0, 0};     ///< Centre of the bore [m].
};

/// Returns the forces at the points [N], one for each point.
///
/// A force without a pin is distributed uniformly, in proportion to the shares. The force of a pin
/// acts radially on that half of the rim that it points to, and is proportional to the cosine of
/// the angle from the force (n nᵀ a with the normal n; a is such that the sum is the force). A
/// moment gives forces perpendicular to the distance from the weighted centre of the points and
/// proportional to that distance, like a rotating disc.
/// @param shares  weights of the points in a uniformly distributed force (sum 1)
/// @return an empty vector if the points cannot carry the load: there are no points, the rim in
///         front of a pin does not hold it in both directions, or a moment has no lever
std::vector<Vec2> spread(const ForceSpread& load, std::span<const Vec2> points,
                         std::span<const double> shares);

}  // namespace flexmorph::verification
