#pragma once

#include <span>
#include <utility>
#include <vector>

#include "geometry/base.h"

namespace flexmorph {

/// Returns true if two sides meet anywhere except in a common end vertex, or if they overlap beyond
/// that vertex. The test is exact. Its time is nearly linear in the number of sides if they are
/// short.
///
/// Outlines of exact unions have no such sides, but their vertices are rounded to double, and then
/// sides may cross.
///
/// @param points  vertices (n) [m]
/// @param sides   pairs of indices of two different points
bool sides_cross(std::span<const Vec2> points,
                 std::span<const std::pair<std::size_t, std::size_t>> sides);

}  // namespace flexmorph
