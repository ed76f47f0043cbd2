#pragma once

#include <algorithm>

#include "fem/dynamics/integrators/step_solver.h"

namespace flexmorph::fem {

/// A mid-point scheme that keeps energy and momenta of what is neither driven nor fed.
///
///   q₁ - q₀ = h v̄,   v̄ = ½ (v₀ + v₁),   ā = (v₁ - v₀) / h
///   M ā + F̄(q₀, q₁) + Φ̄_qᵀ λ̄ = 0   at (q̄, v̄, t̄) with F̄ of MeanForceTerm
///   Φ(q₁, t₁) = 0
///
/// Times q₁ - q₀ the equation of motion says T₁ - T₀ + U₁ - U₀ = -λ̄ · Φ̄_q (q₁ - q₀), and Φ̄_q, the
/// Jacobian at the mean state, takes q₁ - q₀ to Φ₁ - Φ₀ for every Φ of degree 2 in q. So:
///
///   kept to the accuracy of Newton's method   the energy, with undriven joints of degree 2; linear
///       and angular momentum as far as loads and joints leave them
///   order 2    positions and velocities, always: also driven, also with material flow (mass and
///       flow forces at mid-step), where nothing is kept
///   multipliers and accelerations are means over the step: order 2 in its middle (step_mean()),
///       order 1 at its end. make_consistent() finds those of the end, of order 2.
///
/// The velocities of driven joints (Φ_t ≠ 0) would go on with v₁ = 2 v̄ - v₀, a sign-changing error
/// of h²; after such a step they are set right, the rest follows as in Newton's method, and λ̄ takes
/// the impulse in. Joints that are not driven keep Φ_q v = 0 by themselves where Φ is linear; where
/// it is of degree 2 they miss it by a bounded error of order h² (setting it right would cost
/// energy), and λ̄ carries a sign-changing error of order h: the mean of two neighbours is of
/// order 2. Nothing is damped: unresolved frequencies keep ringing.
///
/// Source: Simo & Tarnow (1992), Z. angew. Math. Phys. 43, 757-792; Gonzalez (1999), Physica D 132,
/// 165-174, for constraints; fem/README.md, Energy and momentum.
class EnergyMomentum final : public StepSolver {
 public:
  EnergyMomentum(Workspace& model, const EnergyMomentumSettings& settings);
  const State* step_mean() const override { return &mean_; }

 private:
  void begin(const State& x, double h) override;
  double scale() const override { return 0.5 * h_ * h_; }
  void residual(VectorXd& force, VectorXd& constraint) override;
  void tangent(SparseMatrix& out) override;
  void correct(const VectorXd& dq, const VectorXd& dlambda) override;
  const VectorXd& iterate() const override { return end_.q; }
  /// The work of a residual over the step counts, so the step does.
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
