#pragma once

#include <span>
#include <vector>

#include "geometry/parts/outline_curves.h"

namespace flexmorph {

/// Returns a chain of arcs and lines from the first to the last point of a polyline of two points
/// or more. The chain and the polyline are within `tolerance` of each other [m].
///
/// Pairs of arcs (biarcs) join points of the polyline, the farthest ones for which the tolerance
/// holds. Both arcs meet in a common direction, and so do pairs, in that of the circle through a
/// point and its neighbours. Where no pair joins two neighbours, their side does.
///
/// @param closed  the polyline ends where it begins, and goes on smoothly there
CurveRing biarcs_along(std::span<const Vec2> points, bool closed, double tolerance);

}  // namespace flexmorph
