#pragma once

#include <span>
#include <vector>

#include "geometry/parts/part_mesh.h"

namespace flexmorph {

/// Returns regions without the waves that chains of components leave along nearly straight
/// outlines.
///
/// Along every ring, points p_i at a distance of h = feature / 12 move to
///
///   q = argmin Σ |q_i - p_i|² + Σ w_i (L / 2πh)⁴ |q_{i-1} - 2 q_i + q_{i+1}|²,
///
/// a low-pass filter whose response to a wave of the length l is 1 / (1 + (L / l)⁴), L = 5
/// features. The weight w_i falls from 1 to 0 where the outline turns by 20 to 45 degrees within
/// four features, so that corners and fillets keep their shape. Straight lines stay, and the
/// enclosed area is kept to second order. No point moves by more than 0.12 features. Vertices on
/// `fixed` rings stay, and those that do not move are in the result bit for bit.
///
/// A region whose rings would cross stays as it is, if `check` is set.
/// @param fixed      rings on which nothing moves
/// @param mirrors    lines of symmetry: a ring that has a vertex on one of them is smoothed
///                   symmetrically to round-off
/// @param kept       nothing moves within one feature of these points; beyond two they do not count
/// @param feature    smallest width of the material [m]; 0: nothing moves
/// @param tolerance  of the sides of the result from the curves through the moved points [m]
std::vector<Region> smoothed(std::span<const Region> regions,
                             std::span<const std::vector<Vec2>> fixed,
                             std::span<const Segment> mirrors, std::span<const Vec2> kept,
                             double feature, double tolerance, bool check = true);

}  // namespace flexmorph
