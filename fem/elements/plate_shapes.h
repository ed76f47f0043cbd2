#pragma once

#include <array>
#include <utility>

#include "fem/shapes/shape.h"

/// Shape functions of a rectangular plate element as products of Hermite functions along m and n.
namespace flexmorph::fem::plate {

/// Row of four polynomial coefficients, powers or function values.
using Row4 = Eigen::RowVector4d;

/// Returns the powers (1, s, s², s³).
inline Row4 powers(double s) { return {1, s, s * s, s * s * s}; }

/// Corners of an element as (end along m, end along n), in the order of its shape functions.
constexpr std::array<std::pair<int, int>, 4> kCorners = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};

/// Returns the number of the Hermite function along m of unknown k (r, r_m, r_n, r_mn) of a corner
/// at end a of the interval.
constexpr int function_m(int a, int k) { return 2 * a + (k == 1 || k == 3); }
/// Returns the number of the Hermite function along n of unknown k (r, r_m, r_n, r_mn) of a corner
/// at end b of the interval.
constexpr int function_n(int b, int k) { return 2 * b + (k >= 2); }

/// Values of a Hermite interval at one point: a row of four functions per derivative.
struct At {
  /// Values, and first and second derivatives by the material coordinate.
  Row4 f, d, dd;
  /// Rates of f (first and second), of d and of dd at a fixed material point.
  Row4 f_t, f_tt, d_t, dd_t;
};

/// Returns the values at s in [0, 1]; rates and second derivatives are zero unless wanted.
inline At at_point(const Hermite& h, double s, bool rates, bool curvature = false) {
  const Row4 p = powers(s);
  At out;
  out.f = p * h.value.transpose();
  out.d = p * derivative(h.value).transpose() / h.length;
  if (curvature)
    out.dd = p * derivative(derivative(h.value)).transpose() / (h.length * h.length);
  else
    out.dd.setZero();
  if (rates) {
    out.f_t = p * h.rate.transpose();
    out.f_tt = p * h.acceleration.transpose();
    out.d_t = p * derivative(h.rate).transpose() / h.length;
  } else {
    out.f_t.setZero();
    out.f_tt.setZero();
    out.d_t.setZero();
  }
  if (rates && curvature)
    out.dd_t = p * derivative(derivative(h.rate)).transpose() / (h.length * h.length);
  else
    out.dd_t.setZero();
  return out;
}

}  // namespace flexmorph::fem::plate
