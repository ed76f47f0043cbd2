#pragma once

#include <vector>

#include "geometry/base.h"

namespace flexmorph {

/// Returns a simple ring with fewer vertices. Omitted vertices are within a tolerance [m] of the
/// sides of the result (GEOS). The sense of rotation is kept.
/// @throws Error (numerical) when GEOS returns no result.
std::vector<Vec2> simplified(const std::vector<Vec2>& ring, double tolerance);
/// Returns a polyline with fewer points. Its first and last point are kept; omitted points are
/// within a tolerance [m] of the sides of the result (GEOS).
/// @throws Error (numerical) when GEOS returns no result.
std::vector<Vec2> simplified_line(const std::vector<Vec2>& line, double tolerance);

}  // namespace flexmorph
