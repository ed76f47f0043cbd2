#pragma once

#include <span>
#include <vector>

#include "io/case_files/formula.h"

namespace flexmorph::io {

/// A smooth function through points (times[i], values[i]): an interpolating spline of degree 5 with
/// continuous derivatives up to the fourth; of 4 or 5 points the polynomial of degree 3 or 4
/// through them. Value, rate and acceleration converge with order 6, 5, 4 in the distance of the
/// points.
///
/// Knots are averages of neighbouring times, coefficients solve the banded interpolation equations
/// (de Boor 1978, A Practical Guide to Splines, chapter XIII). Defined from the first time to the
/// last.
class SmoothTable {
 public:
  /// @throws Error (input) for fewer than 4 points, lists of different length, entries that are not
  ///         finite, times that do not increase: naming the row, counted from 1.
  SmoothTable(std::span<const double> times, std::span<const double> values);

  /// Allocates nothing. @throws Error (input) outside of [first(), last()].
  Jet operator()(double t) const;

  double first() const { return breaks_.front(); }  ///< time of the first point [s]
  double last() const { return breaks_.back(); }    ///< time of the last point [s]

 private:
  std::vector<double> breaks_;        // where one polynomial ends and the next begins
  std::vector<double> coefficients_;  // six per interval, of (t - its start)^k
};

}  // namespace flexmorph::io
