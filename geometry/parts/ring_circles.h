#pragma once

#include <span>
#include <vector>

#include "geometry/disc.h"

/// Circles that sides of polygons are chords of.
namespace flexmorph {

/// Tells whether a point lies on a circle to round-off: to 1e-9 of its radius.
bool lies_on(const Disc& circle, const Vec2& point);

/// Returns the circles on which five or more vertices in a row of a ring lie to round-off. All
/// vertices of a circle give its centre and radius by least squares.
/// @param sagitta  how far the middles of sides may be off a circle [m]
std::vector<Disc> circles_of(std::span<const std::vector<Vec2>> rings, double sagitta);

/// Returns for every side of a ring (n) the index of the circle that it is a chord of, or a part of
/// a chord that begins or ends on the circle; -1: none. Side k begins at vertex k.
/// @param sagitta  as that of circles_of() [m]
std::vector<int> circles_of_sides(std::span<const Vec2> ring, std::span<const Disc> circles,
                                  double sagitta);

}  // namespace flexmorph
