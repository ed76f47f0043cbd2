#pragma once

#include <span>
#include <vector>

#include "geometry/base.h"

namespace flexmorph {

/// A straight line between two points [m].
struct Segment {
  Vec2 a, b;  ///< First and last point [m].
};

/// Returns the point of a segment that is nearest to a point [m].
Vec2 nearest_on(const Segment& s, const Vec2& point);
/// Returns the distance of a point from a segment [m].
double distance(const Segment& s, const Vec2& point);
/// Returns the sides of closed rings, in their order.
std::vector<Segment> sides_of(std::span<const std::vector<Vec2>> rings);

}  // namespace flexmorph
