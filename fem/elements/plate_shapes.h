#pragma once

#include <array>
#include <utility>

#include "fem/shapes/shape.h"

/// Shape functions of a rectangular plate element as products of Hermite functions along m and n.
namespace flexmorph::fem::plate {

using Row4 = Eigen::RowVector4d;

inline Row4 powers(double s) { return {1, s, s * s, s * s * s}; }

/// Corners of an element in the order of its shape functions, as in vectors_.
constexpr std::array<std::pair<int, int>, 4> kCorners = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};

/// Which of the four Hermite functions along m (n) belongs to unknown k (r, r_m, r_n, r_mn) of a
/// corner at end a (b).
constexpr int function_m(int a, int k) { return 2 * a + (k == 1 || k == 3); }
constexpr int function_n(int b, int k) { return 2 * b + (k >= 2); }

}  // namespace flexmorph::fem::plate
