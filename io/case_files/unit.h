#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

/// Units of the numbers in case files.
namespace flexmorph::io {

/// Exponents of the base units m, kg, s, K and rad. The radian is a base unit here, so that
/// frequencies in Hz cannot be mistaken for angular velocities.
using Dimension = std::array<int, 5>;

/// A unit, such as "N/mm". Its value in SI units is numerator / denominator.
struct Unit {
  double numerator = 1, denominator = 1;  ///< Whole numbers wherever the unit permits.
  Dimension dimension{};                  ///< Exponents of the base units.

  /// Returns a value in SI units. "12 mm" becomes the double that is nearest to 0.012.
  double si(double value) const { return value * numerator / denominator; }
};

/// Returns the unit of a text: products and quotients of named units with exponents, such as
/// "N/mm", "kg/m^3", "N m s/rad" or "W/(m K)". Each sign / applies to the next factor.
/// @returns nothing if the text is not a unit
std::optional<Unit> read_unit(std::string_view text);

/// Returns the units that a case file can use for a number in a unit, for messages: "m, mm, cm".
/// @param unit  unit of a key, such as "N/m"
std::string units_like(const std::string& unit);

}  // namespace flexmorph::io
