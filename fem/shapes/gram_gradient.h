#pragma once

#include "fem/term.h"

namespace flexmorph::fem {

/// Mean force and tangent for a term whose energy U is objective, but not quadratic in invariants:
/// the discrete gradient of Gonzalez, element by element, computed from strain_energy(),
/// add_force() and add_tangent() of the term.
///
///   F̄ = f(q̄) + 2R/|A|² Lᵀ A L q̄,   R = U₁ - U₀ - f(q̄) · d,   d = q₁ - q₀
///   A = Q₁ Q₁ᵀ - Q₀ Q₀ᵀ,   Q = L q
///
/// L (n × n)  subtracts the first position from positions and scales gradients by the element size
/// [m] A (n × n)  change of the Gram matrix over the step [m²]
///
/// Gonzalez corrects the mid-point force along the step d itself. The correction along the change
/// of the Gram matrix has neither a resultant (because of L) nor a moment (because A is symmetric).
/// Therefore both momenta are conserved as well as f conserves them, in the plane and in space. F̄
/// · d = U₁ - U₀, because (Lᵀ A L q̄) · d = ½ |A|². F̄ differs from the force at the mean state by
/// O(|d|²).
///
/// Where |A| is below 1e-7 of the Gram matrix (the element moves as a rigid body) the quotient
/// R/|A| would consist of round-off. There F̄ = f(q̄), which is exact for a rigid motion. The
/// remaining energy error R is at most of the order 1e-7 |d|² of the element's stiffness.
///
/// Source: Gonzalez (1996), J. Nonlinear Sci. 6, 449-467; with invariants of the motion as Gonzalez
/// (2000), Comput. Methods Appl. Mech. Eng. 190, 1763-1783, does for continua.
///
/// Use: a member of the term, `gradient_.prepare(element)` in its prepare(), and
/// `gradient_.add_force(*this, e, x, force)` as its add_mean_force().
class GramGradient {
 public:
  /// Stores the element, which must exist until the next call; its first shape function must be a
  /// position.
  void prepare(const Element& element) { element_ = &element; }
  /// Adds the mean force F̄ of element e.
  void add_force(const Term& term, int e, const LocalStep& x, LocalRows& force) const;
  /// Adds the derivative of F̄, see MeanForceTerm::add_mean_tangent().
  void add_tangent(const Term& term, int e, const LocalStep& x, const Weights& w,
                   LocalTangent& tangent) const;

 private:
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxShapes, kMaxShapes>;
  struct Correction {
    Square relative, change;     // L, A
    LocalRows middle;            // L q̄
    LocalRows force;             // f(q̄)
    double error = 0, norm = 0;  // energy error R, |A|²
    double factor() const { return norm > 0 ? 2 * error / norm : 0; }
  };
  void correction(const Term& term, int e, const LocalStep& x, Correction& out) const;

  const Element* element_ = nullptr;
};

}  // namespace flexmorph::fem
