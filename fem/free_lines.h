#pragma once

#include <array>

#include "fem/element.h"
#include "fem/shapes/shape.h"

namespace flexmorph::fem {

/// Material lines around an element, in this order.
enum Side { kM1, kM2, kN1, kN2, kSides };

/// Shape functions of an element of which at least one line is an unknown p_l, at quadrature
/// points.
///
/// Two kinds of derivatives by the lines are needed. At a *fixed material point* (virtual work of
/// inertia: the material that is there stays there) they are tables. At *fixed local coordinates*
/// (of integrals over the element, whose limits move with the lines) every entry of a table T,
/// which stands for `m_order` derivatives by m or by p_m1, p_m2 and `n_order` ones likewise, is a
/// power of the sides a, b:
///
///   T_k ~ a^(power_m[k] - m_order) b^(power_n[k] - n_order)
struct FreeTable {
  ShapeTable at;                                          ///< as tabulate() fills it
  std::array<MatrixXd, kSides> N_p;                       ///< ∂N/∂p_l at fixed material point
  std::array<std::array<MatrixXd, kSides>, kSides> N_pp;  ///< ∂²N/∂p_l∂p_k likewise, k <= l
  std::array<Motion, kSides> side;                        ///< where the lines are [m]
  std::array<int, kSides> unknown;                        ///< scalar unknown of a line, or -1
  std::vector<int> power_m, power_n;                      ///< (n_shapes)

  double a() const { return side[kM2].value - side[kM1].value; }
  double b() const { return side[kN2].value - side[kN1].value; }
  const MatrixXd& second(int l, int k) const {
    return l >= k ? N_pp[static_cast<size_t>(l)][static_cast<size_t>(k)]
                  : N_pp[static_cast<size_t>(k)][static_cast<size_t>(l)];
  }

  /// ∂T_k/∂p_l = growth(l, k, ...) T_k at fixed local coordinates [1/m].
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
  /// The same of the reference area of a point.
  double area_growth(int l) const {
    return l == kM1 ? -1 / a() : l == kM2 ? 1 / a() : l == kN1 ? -1 / b() : 1 / b();
  }
};

}  // namespace flexmorph::fem
