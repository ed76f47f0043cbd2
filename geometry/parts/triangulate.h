#pragma once

#include <array>
#include <vector>

#include "geometry/components/outline.h"

namespace flexmorph {

/// Triangles that fill a region.
struct Triangulation {
  /// Vertices of the region, outer ring first, then points where sides cross [m].
  std::vector<Vec2> points;
  std::vector<std::array<int, 3>> triangles;  ///< Indices of the corners, counterclockwise.
};

/// Returns the constrained Delaunay triangulation (CGAL) of a polygon with holes. It adds points
/// only where edges cross, which may happen by round-off.
/// @throws Error (numerical) when there is no triangle.
Triangulation triangulate(const Region& region);

}  // namespace flexmorph
