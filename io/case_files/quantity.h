#pragma once

#include <limits>
#include <string>

namespace flexmorph::io {

/// The limits of a number in a case file. allowed() describes them at the end of error messages.
struct Quantity {
  std::string noun = {};  ///< Noun with article, such as "a thickness".
  std::string unit = {};  ///< Unit, such as "m"; empty for a pure number.
  double lower = -std::numeric_limits<double>::infinity();  ///< Lower limit.
  double upper = std::numeric_limits<double>::infinity();   ///< Upper limit.
  bool lower_open = false, upper_open = false;  ///< True if the limit itself is excluded.

  /// Returns true if a value is finite and within the limits.
  bool holds(double value) const;
  /// Returns the limits as text, such as "a thickness is positive [m]".
  std::string allowed() const;
};
/// Returns the quantity of any finite number.
Quantity any_number(std::string noun, std::string unit = "");
/// Returns the quantity of a number above 0.
Quantity positive(std::string noun, std::string unit = "");
/// Returns the quantity of a number of at least 0.
Quantity not_negative(std::string noun, std::string unit = "");
/// Returns the quantity of a number between two limits, which are included.
Quantity between(std::string noun, std::string unit, double lower, double upper);

}  // namespace flexmorph::io
