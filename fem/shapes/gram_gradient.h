#pragma once

#include "fem/term.h"

namespace flexmorph::fem {

/// Mean force and tangent for a term whose energy U is objective, but not quadratic in invariants:
/// the discrete gradient of Gonzalez, element by element, in terms of the term's own
/// strain_energy(), add_force() and add_tangent().
///
///   F̄ = f(q̄) + 2R/|A|² Lᵀ A L q̄,   R = U₁ - U₀ - f(q̄) · d,   d = q₁ - q₀
///   A = Q₁ Q₁ᵀ - Q₀ Q₀ᵀ,   Q = L q
///
/// L (n × n)  takes positions relative to the first one and slopes times the element size [m]
/// A (n × n)  change of the Gram matrix over the step [m²]
///
/// Gonzalez corrects the mid-point force along the step d itself; along the change of the Gram
/// matrix the correction has neither resultant (L) nor moment (A is symmetric), so that it keeps
/// both momenta as far as f does, in the plane and in space. F̄ · d = U₁ - U₀, because
/// (Lᵀ A L q̄) · d = ½ |A|². F̄ is the force at the mean state but for O(|d|²).
///
/// Where A is below 1e-7 of the Gram matrix (the element moves as a rigid body) the quotient R/|A|
/// would be round-off: there F̄ = f(q̄), which in a rigid motion is exact. What this leaves of R is
/// at most of the order 1e-7 |d|² of the element's stiffness.
///
/// Source: Gonzalez (1996), J. Nonlinear Sci. 6, 449-467; with invariants of the motion as Gonzalez
/// (2000), Comput. Methods Appl. Mech. Eng. 190, 1763-1783, does for continua.
///
/// Use: a member of the term, `gradient_.prepare(element)` in its prepare(), and
/// `gradient_.add_force(*this, e, x, force)` as its add_mean_force().
class GramGradient {
 public:
  /// The element must stay where it is until the next call; its first shape function is a position.
  void prepare(const Element& element) { element_ = &element; }
  void add_force(const Term& term, int e, const LocalStep& x, LocalRows& force) const;
  void add_tangent(const Term& term, int e, const LocalStep& x, const Weights& w,
                   LocalTangent& tangent) const;

 private:
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxShapes, kMaxShapes>;
  struct Correction {
    Square relative, change;      // L, A
    LocalRows middle;             // L q̄
    LocalRows force;              // f(q̄)
    double defect = 0, norm = 0;  // R, |A|²
    double factor() const { return norm > 0 ? 2 * defect / norm : 0; }
  };
  void correction(const Term& term, int e, const LocalStep& x, Correction& out) const;

  const Element* element_ = nullptr;
};

}  // namespace flexmorph::fem
