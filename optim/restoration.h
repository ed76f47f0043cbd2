#pragma once

#include "optim/search.h"

namespace flexmorph::optim {

/// Returns the design x + d (n) with the smallest change d that satisfies the linearised
/// constraints:
///
///   min ½ |d|²   s.t.   g + dg d <= 0,   lower <= x + d <= upper,   |d_j| <= limit
///
/// An entry of d that would exceed its bounds is fixed there, and the remaining entries compensate
/// for it as long as there are any.
VectorXd restored(const Point& point, const VectorXd& lower, const VectorXd& upper, double limit);

}  // namespace flexmorph::optim
