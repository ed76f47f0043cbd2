#pragma once

#include <span>
#include <utility>
#include <vector>

#include "geometry/base.h"

namespace flexmorph {

/// Do two sides meet anywhere but in a vertex that both end in, or do they share more than that
/// vertex? Exact. Near linear in the sides where they are short.
///
/// Outlines of exact unions do not; rounded to doubles, they may.
///
/// @param points  (n) [m]
/// @param sides   pairs of different points, by their numbers
bool sides_cross(std::span<const Vec2> points,
                 std::span<const std::pair<std::size_t, std::size_t>> sides);

}  // namespace flexmorph
