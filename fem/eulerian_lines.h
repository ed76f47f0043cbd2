#pragma once

#include <array>

#include "fem/element.h"
#include "fem/shapes/shape.h"

namespace flexmorph::fem {

/// Material lines around an element: m₁, m₂, n₁, n₂ in this order, and their number.
enum Side { kM1, kM2, kN1, kN2, kSides };

/// Shape functions at quadrature points of an element with at least one free line, that is a line
/// whose material coordinate p_l is an unknown.
///
/// Two kinds of derivatives by the line coordinates are needed. Derivatives at a *fixed material
/// point* are stored as tables; the virtual work of inertia needs them, because the material at a
/// point stays the same. Derivatives at *fixed local coordinates* are needed for integrals over the
/// element, whose limits move with the lines. They follow from powers of the side lengths a, b: an
/// entry of a table T with `m_order` derivatives by m (or by p_m1, p_m2) and `n_order` derivatives
/// by n (or by p_n1, p_n2) is
///
///   T_k ~ a^(power_m[k] - m_order) b^(power_n[k] - n_order)
struct EulerianTable {
  ShapeTable at;                     ///< Tables of ShapeElement::tabulate().
  std::array<MatrixXd, kSides> N_p;  ///< Derivatives ∂N/∂p_l at a fixed material point.

  /// Second derivatives ∂²N/∂p_l∂p_k at a fixed material point, k <= l.
  std::array<std::array<MatrixXd, kSides>, kSides> N_pp;
  std::array<Motion, kSides> side;    ///< Material coordinates of the lines with their rates [m].
  std::array<int, kSides> unknown;    ///< Number of the scalar unknown of each line, or -1.
  std::vector<int> power_m, power_n;  ///< Exponents of the side lengths a and b (n_shapes).

  /// Returns the side length a = m₂ - m₁ [m].
  double a() const { return side[kM2].value - side[kM1].value; }
  /// Returns the side length b = n₂ - n₁ [m].
  double b() const { return side[kN2].value - side[kN1].value; }
  /// Returns ∂²N/∂p_l∂p_k for any order of l and k.
  const MatrixXd& second(int l, int k) const {
    return l >= k ? N_pp[static_cast<size_t>(l)][static_cast<size_t>(k)]
                  : N_pp[static_cast<size_t>(k)][static_cast<size_t>(l)];
  }

  /// Returns the factor g of ∂T_k/∂p_l = g T_k at fixed local coordinates [1/m].
  double growth(int l, int k, int m_order, int n_order) const {
    const auto i = static_cast<size_t>(k);
    switch (l) {
      case kM1:
        return -(power_m[i] - m_order) / a();
      case kM2:
        return (power_m[i] - m_order) / a();
      case kN1:
        return -(power_n[i] - n_order) / b();
      default:
        return (power_n[i] - n_order) / b();
    }
  }
  /// Returns the factor g of ∂A/∂p_l = g A at fixed local coordinates, with A the reference area of
  /// a point [1/m].
  double area_growth(int l) const {
    return l == kM1 ? -1 / a() : l == kM2 ? 1 / a() : l == kN1 ? -1 / b() : 1 / b();
  }
};

}  // namespace flexmorph::fem
