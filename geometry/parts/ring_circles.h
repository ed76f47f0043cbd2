#pragma once

#include <span>
#include <vector>

#include "geometry/disc.h"

/// Circles whose chords are sides of polygons.
namespace flexmorph {

/// Returns true if a point lies on a circle to round-off (1e-9 of its radius).
bool lies_on(const Disc& circle, const Vec2& point);

/// Returns the circles on which five or more consecutive vertices of a ring lie to round-off. The
/// center and radius of a circle are the least-squares fit of all its vertices.
/// @param sagitta  largest distance of the middle of a side from its circle [m]
std::vector<Disc> circles_of(std::span<const std::vector<Vec2>> rings, double sagitta);

/// Returns for every side of a ring the index of the circle of which it is a chord, or part of a
/// chord that begins or ends on the circle; -1 if there is none (n). Side k begins at vertex k.
/// @param sagitta  largest distance of the middle of a side from its circle [m]
std::vector<int> circles_of_sides(std::span<const Vec2> ring, std::span<const Disc> circles,
                                  double sagitta);

}  // namespace flexmorph
