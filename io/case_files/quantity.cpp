#include "io/case_files/quantity.h"

#include <cmath>
#include <utility>

#include "io/files.h"

namespace flexmorph::io {

bool Quantity::holds(double value) const {
  return std::isfinite(value) && (lower_open ? value > lower : value >= lower) &&
         (upper_open ? value < upper : value <= upper);
}

std::string Quantity::allowed() const {
  const bool has_lower = std::isfinite(lower), has_upper = std::isfinite(upper);
  std::string text = noun;
  if (has_lower && has_upper) {
    text += " lies between " + to_text(lower) + " and " + to_text(upper);
    if (lower_open || upper_open) {
      text += std::string(" (") + (lower_open ? to_text(lower) : "") +
              (lower_open && upper_open ? " and " : "") + (upper_open ? to_text(upper) : "") +
              " excluded)";
    }
  } else if (has_lower && lower == 0) {
    text += lower_open ? " is positive" : " is not negative";
  } else if (has_lower) {
    text += (lower_open ? " is above " : " is at least ") + to_text(lower);
  } else if (has_upper) {
    text += (upper_open ? " is below " : " is at most ") + to_text(upper);
  } else {
    text += " is a finite number";
  }
  return unit.empty() ? text : text + " [" + unit + "]";
}

Quantity any_number(std::string noun, std::string unit) {
  return {.noun = std::move(noun), .unit = std::move(unit)};
}

Quantity positive(std::string noun, std::string unit) {
  return {.noun = std::move(noun), .unit = std::move(unit), .lower = 0, .lower_open = true};
}

Quantity not_negative(std::string noun, std::string unit) {
  return {.noun = std::move(noun), .unit = std::move(unit), .lower = 0};
}

Quantity between(std::string noun, std::string unit, double lower, double upper) {
  return {.noun = std::move(noun), .unit = std::move(unit), .lower = lower, .upper = upper};
}

}  // namespace flexmorph::io
