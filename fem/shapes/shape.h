#pragma once

#include <vector>

#include "geometry/base.h"

namespace flexmorph::fem {

/// Value, rate and acceleration of a quantity that is prescribed in time.
struct Motion {
  double value = 0, rate = 0, acceleration = 0;  ///< Value, and first and second derivative.
};

/// Cubic Hermite functions of an interval [x1(t), x2(t)] whose ends may move through the material,
/// and their first and second time derivatives at a fixed material point.
///
///   φ = (H1, a H2, H3, a H4)(s),   s = (X - x1)/a,   a = x2 - x1
///   φ̇ = ∂φ/∂t at fixed X,          φ̈ = ∂²φ/∂t² at fixed X
///
/// All three are cubic polynomials in s, because ṡ = -(ẋ1 + s ȧ)/a is linear in s. Row i of each
/// matrix holds the coefficients of function i (s⁰, s¹, s², s³). Functions 0 and 2 interpolate the
/// value at the ends, functions 1 and 3 the derivative by X (P (3) in one direction). The linear
/// functions are (1 - s, 0, s, 0).
struct Hermite {
  /// Polynomial degree of the functions.
  enum class Degree { linear = 1, cubic = 3 };

  double start = 0, length = 1;  ///< Start x1 and length a of the interval [m].

  /// Coefficients of the functions, of their first and of their second time derivatives.
  Eigen::Matrix4d value, rate, acceleration;

  /// Creates the functions of an interval from the motions of its ends.
  Hermite(const Motion& x1, const Motion& x2, Degree degree = Degree::cubic);
};

/// Returns the derivatives by s of polynomials given by rows of coefficients.
Eigen::Matrix4d derivative(const Eigen::Matrix4d& polynomials);

/// Gauss-Legendre rule on [0, 1], exact up to degree 2 n - 1.
struct GaussRule {
  std::vector<double> points, weights;  ///< Points and weights (n).

  /// Scale factors 1 / Π_{i≠g} (x_g - x_i) of the Lagrange polynomials (n).
  std::vector<double> barycentric;
};
/// Returns the rule with n points, 1 <= n <= 16.
/// @throws Error (input) for other numbers
const GaussRule& gauss(int n);

/// Returns ∫ ℓ_g(s) ds over [lower, upper] within [0, 1], with ℓ_g the Lagrange polynomials through
/// the n Gauss points (n). With these integrals a piecewise constant scale factor is integrated
/// exactly against any polynomial up to degree n - 1: the weights are ω_g = Σ_intervals factor ·
/// ∫_interval ℓ_g.
VectorXd lagrange_integrals(int n, double lower, double upper);

}  // namespace flexmorph::fem
