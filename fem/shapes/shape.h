#pragma once

#include <vector>

#include "geometry/base.h"

namespace flexmorph::fem {

/// Value, rate and acceleration of something prescribed in time.
struct Motion {
  double value = 0, rate = 0, acceleration = 0;
};

/// Cubic Hermite functions of an interval [x1(t), x2(t)] whose ends may move through the material,
/// and their first and second time derivatives at a fixed material point.
///
///   φ = (H1, a H2, H3, a H4)(s),   s = (X - x1)/a,   a = x2 - x1
///   φ̇ = ∂φ/∂t at fixed X,          φ̈ likewise
///
/// All three are cubic polynomials in s, because ṡ = -(ẋ1 + s ȧ)/a is linear in s: row i of each
/// matrix holds the coefficients of function i (s⁰, s¹, s², s³). Functions 0 and 2 interpolate the
/// value at the ends, 1 and 3 the derivative by X (P (3) in one direction). Linear ones are
/// (1 - s, 0, s, 0).
struct Hermite {
  enum class Degree { linear = 1, cubic = 3 };

  double start = 0, length = 1;  ///< x1 and a [m]
  Eigen::Matrix4d value, rate, acceleration;

  Hermite(const Motion& x1, const Motion& x2, Degree degree = Degree::cubic);
};

/// Derivative by s of polynomials given by rows of coefficients.
Eigen::Matrix4d derivative(const Eigen::Matrix4d& polynomials);

/// Gauss-Legendre rule on [0, 1]: exact to degree 2 n - 1.
struct GaussRule {
  std::vector<double> points, weights;
  std::vector<double> barycentric;  ///< 1 / Π_{i≠g} (x_g - x_i), scales of the Lagrange polynomials
};
const GaussRule& gauss(int n);  ///< 1 <= n <= 16

/// ∫ ℓ_g(s) ds over [lower, upper] of [0, 1], ℓ_g the Lagrange polynomials through the n Gauss
/// points (n). With them a factor that is constant over parts of an interval is integrated exactly
/// against any polynomial up to degree n - 1: weights ω_g = Σ_parts factor · ∫_part ℓ_g.
VectorXd lagrange_integrals(int n, double lower, double upper);

}  // namespace flexmorph::fem
