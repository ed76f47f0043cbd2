#pragma once

#include <cstdint>
#include <map>
#include <numeric>
#include <utility>

/// Exact integrals of polynomials, for tests of printed matrices.
namespace flexmorph::testing {

/// A rational number; numerators and denominators of the beam's matrices are far below 2⁶³.
struct Fraction {
  std::int64_t n = 0, d = 1;

  Fraction(std::int64_t numerator = 0, std::int64_t denominator = 1)
      : n(numerator), d(denominator) {
    const std::int64_t common = std::gcd(n, d) * (d < 0 ? -1 : 1);
    n /= common;
    d /= common;
  }
  double value() const { return static_cast<double>(n) / static_cast<double>(d); }
  friend Fraction operator+(Fraction x, Fraction y) { return {x.n * y.d + y.n * x.d, x.d * y.d}; }
  friend Fraction operator-(Fraction x, Fraction y) { return x + Fraction(-y.n, y.d); }
  friend Fraction operator*(Fraction x, Fraction y) { return {x.n * y.n, x.d * y.d}; }
  friend bool operator==(Fraction x, Fraction y) { return x.n == y.n && x.d == y.d; }
};

/// Polynomial in ξ and ζ; its coefficients are stored by the two exponents.
struct Polynomial {
  std::map<std::pair<int, int>, Fraction> terms;

  friend Polynomial operator*(const Polynomial& x, const Polynomial& y) {
    Polynomial out;
    for (const auto& [i, a] : x.terms)
      for (const auto& [j, b] : y.terms) {
        Fraction& c = out.terms[{i.first + j.first, i.second + j.second}];
        c = c + a * b;
      }
    return out;
  }
  friend Polynomial operator-(Polynomial x, const Polynomial& y) {
    for (const auto& [i, a] : y.terms) x.terms[i] = x.terms[i] - a;
    return x;
  }

  /// Returns the integral over ξ in [0, 1], ζ in [-1/2, 1/2]: ∫ ξⁱ = 1/(i + 1), ∫ ζʲ = 2⁻ʲ/(j + 1)
  /// for even j, else 0.
  Fraction integral() const {
    Fraction sum;
    for (const auto& [i, a] : terms)
      if (i.second % 2 == 0)
        sum = sum + a * Fraction(1, i.first + 1) *
                        Fraction(1, (std::int64_t{1} << i.second) * (i.second + 1));
    return sum;
  }
};

}  // namespace flexmorph::testing
