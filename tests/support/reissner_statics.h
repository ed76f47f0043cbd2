#pragma once

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "geometry/base.h"

/// Large static deflections of straight shear-deformable beams by the shooting method. They are
/// used by tests only and share no code or formula with the elements.
namespace flexmorph::reference {

/// A rectangular cross-section and its material.
struct BeamSection {
  double height, width, youngs_modulus, poisson_ratio;
  double shear_modulus() const { return youngs_modulus / (2 * (1 + poisson_ratio)); }
};

/// A function that returns the strains (Γ₁, Γ₂, κ) of a section from its forces (N, Q, M).
using SectionLaw = std::function<Vec3(const Vec3& forces)>;

/// Returns the law N = E A Γ₁, Q = G A Γ₂ (shear factor one), M = E I κ: Reissner (1972), ZAMP 23,
/// 795-804.
inline SectionLaw linear_law(const BeamSection& s) {
  const double area = s.height * s.width, inertia = area * s.height * s.height / 12;
  const Vec3 compliance(1 / (s.youngs_modulus * area), 1 / (s.shear_modulus() * area),
                        1 / (s.youngs_modulus * inertia));
  return [compliance](const Vec3& f) { return Vec3(compliance.cwiseProduct(f)); };
}

/// Returns the law of a section that stays straight and whose height is multiplied by λ, of St.
/// Venant-Kirchhoff material with the enhanced continuum mechanics of fem/README.md, Beams (D⁰ over
/// the section, D^ν by the strains of the axis):
///
///   F e₁ = (1 + Γ₁ - yλκ) t₁ + Γ₂ t₂,   F e₂ = λ t₂
///   ε₁₁ = a₀ + a₁ y + a₂ y²,   ε₂₂ = ½ (λ² - 1),   2ε₁₂ = λ Γ₂
///   w = b/2 ∫ E ε₁₁² + E ε₂₂² + G (2ε₁₂)² dy
///       + b h E ν/(2 - 2ν²) (ν ε₁₁² + ν ε₂₂² + 2ε₁₁ε₂₂)(y = 0)
///
/// The strains and λ make w - N Γ₁ - Q Γ₂ - M κ stationary; they are found by Newton's method with
/// differences of w. The derivative of λ along the beam does not contribute to the energy.
inline SectionLaw kirchhoff_law(const BeamSection& s) {
  using Vec4 = Eigen::Vector4d;
  const auto energy = [s](const Vec4& z) {
    const double stretch = 1 + z[0], shear = z[1], kappa = z[2], lambda = z[3];
    const double a0 = (stretch * stretch + shear * shear - 1) / 2, a1 = -stretch * lambda * kappa,
                 a2 = lambda * lambda * kappa * kappa / 2, across = (lambda * lambda - 1) / 2;
    const double h = s.height, h3 = h * h * h / 12, h5 = std::pow(h, 5) / 80;
    const double nu = s.poisson_ratio, E = s.youngs_modulus;
    const double section =
        E * (a0 * a0 * h + (a1 * a1 + 2 * a0 * a2) * h3 + a2 * a2 * h5 + across * across * h) +
        s.shear_modulus() * std::pow(lambda * shear, 2) * h;
    const double axis =
        h * E * nu / (1 - nu * nu) * (nu * a0 * a0 + nu * across * across + 2 * a0 * across);
    return s.width / 2 * (section + axis);
  };
  return [energy, h = s.height](const Vec3& f) {
    Vec4 z(0, 0, 0, 1), step(1e-3, 1e-3, 1e-3 / h, 1e-3);
    for (int iteration = 0; iteration < 12; ++iteration) {
      // Differences of order 4: w is a polynomial of degree 8 whose high terms are small.
      const auto gradient = [&](const Vec4& at) {
        Vec4 out;
        for (int i = 0; i < 4; ++i) {
          const auto moved = [&](double by) {
            Vec4 y = at;
            y[i] += by * step[i];
            return energy(y);
          };
          out[i] = (8 * (moved(1) - moved(-1)) - (moved(2) - moved(-2))) / (12 * step[i]);
        }
        return out;
      };
      Vec4 r = gradient(z);
      r.head<3>() -= f;
      Eigen::Matrix4d tangent;
      for (int i = 0; i < 4; ++i) {
        Vec4 up = z, down = z;
        up[i] += step[i];
        down[i] -= step[i];
        tangent.col(i) = (gradient(up) - gradient(down)) / (2 * step[i]);
      }
      const Vec4 dz = tangent.partialPivLu().solve(r);
      z -= dz;
      if (dz.cwiseQuotient(step).norm() < 1e-8) break;
    }
    return Vec3(z.head<3>());
  };
}

/// Position of a cross-section, its angle and its moment.
using BeamPoint = std::array<double, 4>;  // x, y, φ, m

/// Integrates the equations of a beam with a constant force n on the right side of every section,
///
///   r' = (1 + Γ₁) t₁ + Γ₂ t₂,   φ' = κ,   m' = -(r' × n),   t₁ = (cos φ, sin φ),
///
/// over a length by the classical Runge-Kutta method.
inline BeamPoint integrate_beam(const SectionLaw& law, const Vec2& n, double length, BeamPoint y,
                                int steps) {
  const auto rate = [&](const BeamPoint& p) {
    const double c = std::cos(p[2]), s = std::sin(p[2]);
    const Vec3 z = law({n.x() * c + n.y() * s, -n.x() * s + n.y() * c, p[3]});
    const double dx = (1 + z[0]) * c - z[1] * s, dy = (1 + z[0]) * s + z[1] * c;
    return BeamPoint{dx, dy, z[2], -(dx * n.y() - dy * n.x())};
  };
  const auto plus = [](const BeamPoint& a, double f, const BeamPoint& b) {
    BeamPoint out;
    for (size_t i = 0; i < 4; ++i) out[i] = a[i] + f * b[i];
    return out;
  };
  const double h = length / steps;
  for (int step = 0; step < steps; ++step) {
    const BeamPoint k1 = rate(y), k2 = rate(plus(y, h / 2, k1)), k3 = rate(plus(y, h / 2, k2)),
                    k4 = rate(plus(y, h, k3));
    for (size_t i = 0; i < 4; ++i) y[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
  }
  return y;
}

/// Returns the downward deflection of the middle [m] of a beam on a pin and a sliding roller under
/// a dead downward force at its middle. Only half of the beam is integrated; the angle at the
/// support is found by bisection so that the angle in the middle is zero.
inline double roller_deflection(const SectionLaw& law, double length, double force,
                                int steps = 100) {
  const auto middle = [&](double angle) {
    return integrate_beam(law, {0, -force / 2}, length / 2, {0, 0, angle, 0}, steps);
  };
  double low = -std::numbers::pi / 2, high = 0;
  if (!(middle(low)[2] < 0 && middle(high)[2] > 0))
    throw Error::numerical("reissner_statics: no bracket for the angle at the support");
  for (int i = 0; i < 45; ++i) {
    const double angle = 0.5 * (low + high);
    (middle(angle)[2] < 0 ? low : high) = angle;
  }
  return -middle(low)[1];
}

}  // namespace flexmorph::reference
