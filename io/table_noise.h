#pragma once

#include <optional>
#include <span>

namespace flexmorph::io {

/// Measured noise of a table of times and values.
struct TableNoise {
  /// Fraction of neighbouring second differences that have opposite signs. It is 0.73 for
  /// independent errors, and below 0.5 for a motion with more than four points per period.
  double sign_changes = 0;
  /// Root mean square of the acceleration from differences over one interval, divided by that from
  /// differences over four intervals. It is near 1 for a smooth motion and 16 for independent
  /// errors.
  double ratio = 0;
};

/// Returns the noise of a table that would dominate the acceleration of a curve through its points;
/// nothing if the table is smooth or has less than 16 points.
///
/// A table is noisy if most neighbouring second differences have opposite signs, the ratio exceeds
/// 4, and the acceleration of the errors exceeds the range of the values divided by the square of
/// the time span. The last condition excludes tables whose only errors are their last digits.
/// @param times   ascending times [s] (n)
/// @param values  values at these times (n)
std::optional<TableNoise> noise_of(std::span<const double> times, std::span<const double> values);

}  // namespace flexmorph::io
