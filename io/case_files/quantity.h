#pragma once

#include <limits>
#include <string>

namespace flexmorph::io {

/// What a number in a case file may be; allowed() is the end of the message when it is not.
struct Quantity {
  std::string noun = {};  ///< "a thickness"
  std::string unit = {};  ///< "m"; empty for a pure number
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  bool lower_open = false, upper_open = false;  ///< is the limit itself excluded?

  bool holds(double value) const;  ///< finite and within the limits
  std::string allowed() const;     ///< "a thickness is positive [m]"
};
Quantity any_number(std::string noun, std::string unit = "");
Quantity positive(std::string noun, std::string unit = "");
Quantity not_negative(std::string noun, std::string unit = "");
Quantity between(std::string noun, std::string unit, double lower, double upper);

}  // namespace flexmorph::io
