#pragma once

#include <span>
#include <vector>

#include "io/case_files/formula.h"

namespace flexmorph::io {

/// A smooth function through points (times[i], values[i]). It is an interpolating spline of degree
/// 5 with continuous derivatives up to the fourth; for 4 or 5 points it is the polynomial of degree
/// 3 or 4 through them. Value, rate and acceleration converge with the orders 6, 5 and 4 in the
/// distance of the points. The function is defined from the first to the last time.
///
/// The knots are averages of neighbouring times, and the coefficients solve the banded
/// interpolation equations.
///
/// Source: de Boor (1978), A Practical Guide to Splines, chapter XIII.
class SmoothTable {
 public:
  /// Computes the spline.
  /// @throws Error (input) for fewer than 4 points, lists of different length, entries that are not
  ///         finite, times that do not increase (the message names the row, counted from 1), or
  ///         times so uneven that the spline loses its accuracy.
  SmoothTable(std::span<const double> times, std::span<const double> values);

  /// Returns value, rate and acceleration at the time t [s]. It allocates no memory.
  /// @throws Error (input) outside [first(), last()].
  Jet operator()(double t) const;

  /// Returns the time of the first point [s].
  double first() const { return breaks_.front(); }
  /// Returns the time of the last point [s].
  double last() const { return breaks_.back(); }

 private:
  std::vector<double> breaks_;        // times at which one polynomial ends and the next one begins
  std::vector<double> coefficients_;  // six per interval, of the powers of t minus its start
};

}  // namespace flexmorph::io
