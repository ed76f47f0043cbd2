#pragma once

#include <algorithm>

#include "fem/dynamics/integrators/step_solver.h"

namespace flexmorph::fem {

/// Returns true if all terms and force elements of a model have the mean forces of a step that
/// EnergyMomentum needs (MeanForceTerm, MeanForceElement).
bool has_mean_forces(const Model& model);

/// A mid-point integrator that conserves energy and momenta if nothing drives the model and no
/// material is fed.
///
///   q₁ - q₀ = h v̄,   v̄ = ½ (v₀ + v₁),   ā = (v₁ - v₀) / h
///   M ā + F̄(q₀, q₁) + Φ̄_qᵀ λ̄ = 0   at (q̄, v̄, t̄) with F̄ of MeanForceTerm
///   Φ(q₁, t₁) = 0
///
/// The product of the equation of motion with q₁ - q₀ is T₁ - T₀ + U₁ - U₀ = -λ̄ · Φ̄_q (q₁ - q₀).
/// The Jacobian Φ̄_q at the mean state maps q₁ - q₀ to Φ₁ - Φ₀ for every Φ of degree 2 in q.
/// Therefore:
///
///   - The energy is conserved to the accuracy of Newton's method if undriven joints have degree 2.
///     Linear and angular momentum are conserved as far as loads and joints allow it.
///   - Positions and velocities always have order 2, also with drives and with material flow (mass
///     and flow forces at mid-step), where nothing is conserved.
///   - Multipliers and accelerations are means over the step. They have order 2 at its middle
///     (step_mean()) and order 1 at its end. make_consistent() computes the
///     values at the end with order 2.
///
/// The velocities of driven joints (Φ_t ≠ 0) would continue with v₁ = 2 v̄ - v₀, an error of order
/// h² with alternating sign. Therefore they are corrected after every such step; the other
/// velocities follow as in Newton's method, and λ̄ includes the impulse. Undriven joints satisfy
/// Φ_q v = 0 without correction if Φ is linear. If Φ has degree 2, they violate it by a bounded
/// error of order h² (a correction would change the energy), and λ̄ has an error of order h with
/// alternating sign; the mean of two consecutive values has order 2. Nothing is damped: unresolved
/// frequencies continue to ring.
///
/// Source: Simo & Tarnow (1992), Z. angew. Math. Phys. 43, 757-792; Gonzalez (1999), Physica D 132,
/// 165-174, for constraints; fem/README.md, Energy and momentum.
class EnergyMomentum final : public StepSolver {
 public:
  /// Creates the integrator for a model, which must outlive it.
  /// @throws Error (input) if the settings are invalid.
  EnergyMomentum(Workspace& model, const EnergyMomentumSettings& settings);
  const State* step_mean() const override { return &mean_; }

 private:
  void begin(const State& x, double h) override;
  double scale() const override { return 0.5 * h_ * h_; }
  void residual(VectorXd& force, VectorXd& constraint) override;
  void tangent(SparseMatrix& out) override;
  void correct(const VectorXd& dq, const VectorXd& dlambda) override;
  const VectorXd& iterate() const override { return end_.q; }
  /// Returns the displacement of the step, at most size(): the energy error is the work of the
  /// residual over this displacement, and therefore the tolerance is related to it.
  double resolved() const override { return std::min(displacement(step_), size()); }
  void finish(State& x) override;
  void set_mean();
  void follow_drives(bool was_driven);

  double h_ = 0;
  State start_, end_, mean_;
  VectorXd step_;  // q₁ - q₀
  VectorXd start_rate_, miss_, none_, dv_, mu_;
  Constraints at_end_, at_mean_;
};

}  // namespace flexmorph::fem
