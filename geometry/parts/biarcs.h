#pragma once

#include <span>
#include <vector>

#include "geometry/parts/outline_curves.h"

namespace flexmorph {

/// Returns a chain of arcs and lines from the first to the last point of a polyline of two or more
/// points. The chain and the polyline are within `tolerance` of each other [m].
///
/// Pairs of arcs (biarcs) connect points of the polyline; each pair extends as far as the tolerance
/// allows. The two arcs of a pair are tangent to each other. Neighbouring pairs are tangent, too:
/// their common direction is the tangent of the circle through the point and its two neighbours.
/// Where no pair of arcs fits between two neighbouring points, a line connects them.
///
/// @param closed  true if the polyline ends where it begins and is smooth there
CurveRing biarcs_along(std::span<const Vec2> points, bool closed, double tolerance);

}  // namespace flexmorph
