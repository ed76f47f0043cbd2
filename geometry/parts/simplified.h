#pragma once

#include <vector>

#include "geometry/base.h"

namespace flexmorph {

/// Returns a simple ring without the vertices that are within a tolerance [m] of the sides of what
/// is left (GEOS), in its sense of rotation.
/// @throws Error (numerical) when GEOS finds no result.
std::vector<Vec2> simplified(const std::vector<Vec2>& ring, double tolerance);
/// Returns a polyline from its first point to its last one without the points between that are
/// within a tolerance [m] of the sides of what is left.
/// @throws Error (numerical) when GEOS finds no result.
std::vector<Vec2> simplified_line(const std::vector<Vec2>& line, double tolerance);

}  // namespace flexmorph
