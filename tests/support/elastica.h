#pragma once

#include <array>
#include <cmath>

/// Inextensible cantilever with a dead transverse load at its tip, solved by the shooting method.
/// It is used by tests only and shares no code or formula with the plate elements.
namespace flexmorph::reference {

struct ElasticaTip {
  double x = 0, z = 0;  ///< Position of the tip as a fraction of the length.
};

/// Returns the tip of the cantilever that obeys θ' = κ, κ' = -α cos θ, x' = cos θ, z' = sin θ on
/// [0, 1] with θ(0) = 0, κ(1) = κ° and α = F L²/(E I). κ° is the curvature of the unloaded beam
/// times its length. κ(0) is found by bisection; each integration takes 4000 steps of the classical
/// Runge-Kutta method.
inline ElasticaTip elastica(double alpha, double rest_curvature = 0) {
  using Y = std::array<double, 4>;  // θ, κ, x, z
  const auto rate = [alpha](const Y& y) {
    return Y{y[1], -alpha * std::cos(y[0]), std::cos(y[0]), std::sin(y[0])};
  };
  const auto shoot = [&](double kappa) {
    Y y{0, kappa, 0, 0};
    const int n = 4000;
    const double h = 1.0 / n;
    const auto plus = [](const Y& a, double f, const Y& b) {
      Y out;
      for (size_t i = 0; i < 4; ++i) out[i] = a[i] + f * b[i];
      return out;
    };
    for (int step = 0; step < n; ++step) {
      const Y k1 = rate(y), k2 = rate(plus(y, h / 2, k1)), k3 = rate(plus(y, h / 2, k2)),
              k4 = rate(plus(y, h, k3));
      for (size_t i = 0; i < 4; ++i) y[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
    }
    return y;
  };
  // Since κ(0)² = κ°² + 2 α sin θ(1) <= κ°² + 2 α, the curvature at the tip is below κ° at the
  // lower bound and above κ° at the upper bound of the bisection.
  double low = rest_curvature, high = std::sqrt(rest_curvature * rest_curvature + 2 * alpha);
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (shoot(middle)[1] < rest_curvature ? low : high) = middle;
  }
  const Y y = shoot(0.5 * (low + high));
  return {y[2], y[3]};
}

}  // namespace flexmorph::reference
