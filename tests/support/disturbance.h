#pragma once

#include <bit>
#include <cstdint>
#include <cstdlib>

#include "fem/section.h"
#include "geometry/base.h"

/// Initial values that differ in the last digits. FLEXMORPH_DISTURBANCE=1, 2, ... changes the
/// initial values of tests that integrate or optimize by a relative amount of at most 1e-13. The
/// outcome of a test must not depend on it; tests/every_processor.sh tries five values. Without the
/// variable no value is changed.
namespace flexmorph::testing {

inline constexpr double kDisturbance = 1e-13;

/// Returns a value changed by at most kDisturbance times itself; the same value and disturbance
/// always give the same result.
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

/// Returns the section with disturbed stiffness and density.
inline fem::PlaneSection disturbed(fem::PlaneSection section) {
  section.youngs_modulus = disturbed(section.youngs_modulus);
  section.density = disturbed(section.density);
  return section;
}

}  // namespace flexmorph::testing
