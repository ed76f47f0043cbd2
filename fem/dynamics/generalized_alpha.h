#pragma once

#include "fem/dynamics/step_solver.h"

namespace flexmorph::fem {

/// Generalized-alpha for index-3 equations of motion, Arnold & Brüls (2007).
///
///   (1 - α_m) a_{n+1} + α_m a_n = (1 - α_f) q̈_{n+1} + α_f q̈_n
///   q_{n+1} = q_n + h q̇_n + h² ((½ - β) a_n + β a_{n+1})
///   q̇_{n+1} = q̇_n + h ((1 - γ) a_n + γ a_{n+1})
///   M q̈ + F + Φ_qᵀ λ = 0,  Φ = 0   at t_{n+1} with the true q̈
///
///   α_m = (2ρ-1)/(ρ+1), α_f = ρ/(ρ+1), γ = ½ + α_f - α_m, β = (γ + ½)²/4
///
/// Source: Arnold, Brüls (2007), Multibody Syst. Dyn. 18, 185-202; design.md section 4.
class GeneralizedAlpha final : public StepSolver {
 public:
  /// @throws Error (input) when rho_inf is outside [0, 1].
  GeneralizedAlpha(Model& model, const AlphaSettings& settings);

 private:
  void begin(const State& x, double h) override;
  double scale() const override { return beta_ * h_ * h_; }
  void residual(VectorXd& force, VectorXd& constraint) override;
  void tangent(SparseMatrix& out) override;
  void correct(const VectorXd& dq, const VectorXd& dlambda) override;
  void finish(State& x) override;
  /// Derivatives of (q, q̇, q̈) by q at the end of the step.
  Weights weights() const;

  double alpha_m_, alpha_f_, beta_, gamma_;
  double h_ = 0;
  State next_;  // the iterate
  Constraints constraints_;
};

}  // namespace flexmorph::fem
