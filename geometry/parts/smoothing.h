#pragma once

#include <span>
#include <vector>

#include "geometry/parts/part_mesh.h"

namespace flexmorph {

/// Returns regions without the waves that chains of components cause along nearly straight
/// outlines.
///
/// Along every ring, points p_i at a distance of h = feature / 12 move to
///
///   q = argmin Σ |q_i - p_i|² + Σ w_i (L / 2πh)⁴ |q_{i-1} - 2 q_i + q_{i+1}|².
///
/// This is a low-pass filter whose response to a wave of the length l is 1 / (1 + (L / l)⁴), where
/// L is 5 features. The weight w_i falls from 1 to nearly 0 where the outline turns by 20 to 45
/// degrees within four features, therefore corners and fillets keep their shape. Straight lines are
/// not changed, and the enclosed area changes only in second order. No point moves by more than
/// 0.12 features. Vertices on `fixed` rings do not move, and vertices that do not move are in the
/// result bit for bit.
///
/// A region whose rings would cross is not changed, if `check` is true.
/// @param fixed      rings on which no point moves
/// @param mirrors    lines of symmetry: a ring that has a vertex on one of them is smoothed
///         symmetrically to round-off
/// @param kept       points within one feature of which nothing moves; beyond two features they
///         have no effect
/// @param feature    smallest width of the material [m]; 0 means that no point moves
/// @param tolerance  largest distance of the sides of the result from the curves through the moved
///         points [m]
/// @param check      true if a region whose rings would cross is left unchanged
std::vector<Region> smoothed(std::span<const Region> regions,
                             std::span<const std::vector<Vec2>> fixed,
                             std::span<const Segment> mirrors, std::span<const Vec2> kept,
                             double feature, double tolerance, bool check = true);

}  // namespace flexmorph
