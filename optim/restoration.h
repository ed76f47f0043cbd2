#pragma once

#include "optim/search.h"

namespace flexmorph::optim {

/// The least change of x that satisfies the linearised constraints.
///
///   min ½ |d|²   s.t.   g + dg d <= 0,   lower <= x + d <= upper,   |d_j| <= limit
///
/// What the bounds forbid is left to the other entries, as long as there are any.
/// @returns x + d (n)
VectorXd restored(const Point& point, const VectorXd& lower, const VectorXd& upper, double limit);

}  // namespace flexmorph::optim
