#pragma once

#include <array>
#include <vector>

#include "geometry/components/outline.h"

namespace flexmorph {

struct Triangulation {
  std::vector<Vec2> points;  ///< vertices of the region, outer ring first [m]; then crossings
  std::vector<std::array<int, 3>> triangles;  ///< counterclockwise
};

/// Constrained Delaunay triangulation (CGAL) of a polygon with holes, without new points but where
/// edges cross, as they may by round-off.
/// @throws Error (numerical) when there is no triangle.
Triangulation triangulate(const Region& region);

}  // namespace flexmorph
