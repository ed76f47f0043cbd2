#pragma once

#include <bit>
#include <cstdint>
#include <cstdlib>

#include "fem/section.h"
#include "geometry/base.h"

/// Starts that differ in the last digits: FLEXMORPH_DISTURBANCE=1, 2, ... moves what tests that
/// integrate or optimize begin with by up to 1e-13 of itself. Verdicts must not depend on it;
/// tests/every_processor.sh tries five. Without the variable nothing is moved.
namespace flexmorph::testing {

inline constexpr double kDisturbance = 1e-13;

/// The same number for the same value and disturbance, within kDisturbance of it.
inline double disturbed(double value) {
  static const char* const number = std::getenv("FLEXMORPH_DISTURBANCE");
  if (!number) return value;
  // A mixing function of 64 bits (splitmix64; Steele, Lea, Flood 2014).
  std::uint64_t x = std::bit_cast<std::uint64_t>(value) +
                    0x9e3779b97f4a7c15u * std::strtoull(number, nullptr, 10);
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  x ^= x >> 31;
  const double part = 2 * static_cast<double>(x >> 11) / static_cast<double>(1ull << 53) - 1;
  return value * (1 + kDisturbance * part);
}

inline VectorXd disturbed(VectorXd values) {
  for (double& x : values) x = disturbed(x);
  return values;
}

/// Stiffness and density: a motion with another material, by its last digits.
inline fem::PlaneSection disturbed(fem::PlaneSection section) {
  section.youngs_modulus = disturbed(section.youngs_modulus);
  section.density = disturbed(section.density);
  return section;
}

}  // namespace flexmorph::testing
