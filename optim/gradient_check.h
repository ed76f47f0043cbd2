#pragma once

#include <functional>
#include <string>
#include <vector>

#include "geometry/base.h"

namespace flexmorph::optim {

/// Remainders of a first-order Taylor expansion over a ladder of steps.
struct TaylorTest {
  std::vector<double> steps;       ///< t, largest first, two per decade
  std::vector<double> remainders;  ///< |f(x + t d) - f(x) - t df·d|
  std::vector<double> orders;      ///< between neighbours; one entry less than steps
  /// Slope of log remainder over log t by least squares, over the steps whose remainder stands
  /// above round-off; infinite when fewer than two do (f is linear along d).
  double order = 0;
  double decades = 0;  ///< of t that the fit covers

  std::string table() const;  ///< t, remainder, order: one line per step
};

/// 2 for the right gradient of a smooth function, 1 for a wrong one.
///
/// @param df         gradient of f at x (n)
/// @param direction  d (n)
/// @param decades    of steps below largest_step
/// @param noise      relative round-off of f, in units of |f|; remainders below ten times it are
///                   left out of the fit
/// @throws Error (input) for vectors of different lengths or steps that are not positive,
///         Error (numerical) when f is not finite.
TaylorTest taylor_test(const std::function<double(const VectorXd&)>& f, const VectorXd& df,
                       const VectorXd& x, const VectorXd& direction, double largest_step,
                       int decades, double noise = 1e-15);

}  // namespace flexmorph::optim
