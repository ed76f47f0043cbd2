#pragma once

#include <vector>

#include "geometry/base.h"

namespace flexmorph {

/// A disc, or the circle around it.
struct Disc {
  Vec2 center{0, 0};  ///< [m]
  double radius = 0;  ///< [m]
};

/// The disc of the area and the centroid of a polygon [m].
/// @param ring  its corners, in either sense
Disc disc_like(const std::vector<Vec2>& ring);

/// Tells whether a polygon is round and has the centre and the radius of a disc, each to the
/// tolerance [m].
bool matches(const std::vector<Vec2>& ring, const Disc& disc, double tolerance);

}  // namespace flexmorph
