#pragma once

#include <vector>

#include "geometry/base.h"

namespace flexmorph {

/// A disc, or the circle that bounds it.
struct Disc {
  Vec2 center{0, 0};  ///< Center [m].
  double radius = 0;  ///< Radius [m].
};

/// Returns the disc that has the area and the centroid of a polygon [m].
/// @param ring  vertices of the polygon, in either sense of rotation
Disc disc_like(const std::vector<Vec2>& ring);

/// Returns true if a polygon is round and has the center and the radius of a disc, each within the
/// tolerance [m].
bool matches(const std::vector<Vec2>& ring, const Disc& disc, double tolerance);

}  // namespace flexmorph
