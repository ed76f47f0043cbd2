#include "fem/shapes/shape.h"

#include <array>
#include <cmath>
#include <numbers>

namespace flexmorph::fem {
namespace {

/// Returns the coefficients of H1..H4 on the unit interval.
Eigen::Matrix4d unit_functions(Hermite::Degree degree) {
  Eigen::Matrix4d h;
  if (degree == Hermite::Degree::linear) {
    h.setZero();
    h(0, 0) = 1;
    h(0, 1) = -1;
    h(2, 1) = 1;
    return h;
  }
  h << 1, 0, -3, 2,  //
      0, 1, -2, 1,   //
      0, 0, 3, -2,   //
      0, 0, -1, 1;
  return h;
}

/// Returns (c0 + c1 s) p(s) up to degree 3, which the products of the callers never exceed.
Eigen::Matrix4d times_linear(const Eigen::Matrix4d& p, double c0, double c1) {
  Eigen::Matrix4d out = c0 * p;
  out.rightCols<3>() += c1 * p.leftCols<3>();
  return out;
}

}  // namespace

Eigen::Matrix4d derivative(const Eigen::Matrix4d& p) {
  Eigen::Matrix4d out;
  out.col(0) = p.col(1);
  out.col(1) = 2 * p.col(2);
  out.col(2) = 3 * p.col(3);
  out.col(3).setZero();
  return out;
}

Hermite::Hermite(const Motion& x1, const Motion& x2, Degree degree)
    : start(x1.value), length(x2.value - x1.value) {
  const double a = length;
  const double a_dot = x2.rate - x1.rate;
  const double a_ddot = x2.acceleration - x1.acceleration;
  // At a fixed material point ṡ = u0 + u1 s and s̈ = w0 + w1 s.
  const double u0 = -x1.rate / a, u1 = -a_dot / a;
  const double w0 = -x1.acceleration / a - 2 * u0 * a_dot / a;
  const double w1 = -a_ddot / a - 2 * u1 * a_dot / a;

  const Eigen::Matrix4d h = unit_functions(degree);
  const Eigen::Matrix4d dh = derivative(h);
  const Eigen::Matrix4d ddh = derivative(dh);
  const Eigen::Matrix4d h_dot = times_linear(dh, u0, u1);
  const Eigen::Matrix4d h_ddot =
      times_linear(dh, w0, w1) + times_linear(times_linear(ddh, u0, u1), u0, u1);

  const Eigen::Vector4d scale(1, a, 1, a), scale_dot(0, a_dot, 0, a_dot),
      scale_ddot(0, a_ddot, 0, a_ddot);
  value = scale.asDiagonal() * h;
  rate = scale.asDiagonal() * h_dot;
  rate += scale_dot.asDiagonal() * h;
  acceleration = scale.asDiagonal() * h_ddot;
  acceleration += 2 * (scale_dot.asDiagonal() * h_dot);
  acceleration += scale_ddot.asDiagonal() * h;
}

namespace {

constexpr int kMaxGauss = 16;

GaussRule make_gauss(int n) {
  GaussRule rule;
  for (int i = 0; i < n; ++i) {
    double x = std::cos(std::numbers::pi * (i + 0.75) / (n + 0.5)), slope = 1;
    for (int newton = 0; newton < 50; ++newton) {
      double p0 = 1, p1 = x;
      for (int k = 2; k <= n; ++k) {
        const double p2 = ((2 * k - 1) * x * p1 - (k - 1) * p0) / k;
        p0 = p1;
        p1 = p2;
      }
      slope = n * (x * p1 - p0) / (x * x - 1);
      const double dx = p1 / slope;
      x -= dx;
      if (std::abs(dx) < 1e-16) break;
    }
    rule.points.push_back(0.5 * (1 - x));
    rule.weights.push_back(1 / ((1 - x * x) * slope * slope));
  }
  for (const double x : rule.points) {
    double product = 1;
    for (const double other : rule.points)
      if (other != x) product *= x - other;
    rule.barycentric.push_back(1 / product);
  }
  return rule;
}

}  // namespace

const GaussRule& gauss(int n) {
  static const std::array<GaussRule, kMaxGauss + 1> rules = [] {
    std::array<GaussRule, kMaxGauss + 1> all;
    for (int k = 1; k <= kMaxGauss; ++k) all[static_cast<size_t>(k)] = make_gauss(k);
    return all;
  }();
  if (n < 1 || n > kMaxGauss) throw Error::input("gauss: the number of points is out of range");
  return rules[static_cast<size_t>(n)];
}

VectorXd lagrange_integrals(int n, double lower, double upper) {
  const GaussRule& nodes = gauss(n);
  const GaussRule& inner = gauss((n + 1) / 2);  // exact for the degree n - 1 of ℓ_g
  VectorXd out = VectorXd::Zero(n);
  for (size_t k = 0; k < inner.points.size(); ++k) {
    const double s = lower + (upper - lower) * inner.points[k];
    // The product of Π_{i<g} (s - x_i) and Π_{i>g} (s - x_i) avoids the division by s - x_g.
    std::array<double, kMaxGauss> below;
    double product = (upper - lower) * inner.weights[k];
    for (size_t g = 0; g < nodes.points.size(); ++g) {
      below[g] = product;
      product *= s - nodes.points[g];
    }
    product = 1;
    for (size_t g = nodes.points.size(); g-- > 0;) {
      out[static_cast<Eigen::Index>(g)] += below[g] * product * nodes.barycentric[g];
      product *= s - nodes.points[g];
    }
  }
  return out;
}

}  // namespace flexmorph::fem
