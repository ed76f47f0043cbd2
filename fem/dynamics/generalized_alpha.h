#pragma once

#include <functional>
#include <vector>

#include "fem/model.h"
#include "fem/solve/linear_solver.h"

namespace flexmorph::fem {

struct AlphaSettings {
  double rho_inf = 0.8;      ///< spectral radius at infinite frequency, 0..1
  double tolerance = 1e-11;  ///< of the last correction, relative to the size of the model
  int max_iterations = 12;   ///< Newton iterations before the step is halved
  int max_halvings = 10;
};

/// What a time integration spent so far.
struct StepCounts {
  int steps = 0, newton = 0, factorizations = 0, rejected = 0;
};

/// Generalized-alpha for index-3 equations of motion, Arnold & Brüls (2007).
///
///   (1 - α_m) a_{n+1} + α_m a_n = (1 - α_f) q̈_{n+1} + α_f q̈_n
///   q_{n+1} = q_n + h q̇_n + h² ((½ - β) a_n + β a_{n+1}),   q̇_{n+1} = q̇_n + h ((1-γ) a_n + γ
///   a_{n+1}) M q̈ + F + Φ_qᵀ λ = 0,  Φ = 0   at t_{n+1} with the true q̈
///
///   α_m = (2ρ-1)/(ρ+1), α_f = ρ/(ρ+1), γ = ½ + α_f - α_m, β = (γ + ½)²/4
///
/// Constraints and multipliers are scaled by β h² (the condition of the iteration matrix then does
/// not depend on h), slopes by the element size. The factored tangent is kept while it contracts.
///
/// Source: Arnold, Brüls (2007), Multibody Syst. Dyn. 18, 185-202; design.md section 4.
class GeneralizedAlpha {
 public:
  GeneralizedAlpha(Model& model, const AlphaSettings& settings);

  /// Consistent q̈, λ from the twice differentiated constraints; the algorithmic acceleration is q̈.
  void make_consistent(State& x);
  /// The same for velocities that miss Φ_q q̇ + Φ_t = 0 a little: the nearest in the mass norm.
  void project_velocity(State& x);

  /// Advances x to t_end in one step; halves and retries where Newton fails, growing back later.
  /// `accepted` sees every accepted step.
  /// @throws Error (numerical) naming time, step and the residual history; x is the last good
  /// state.
  void advance(State& x, double t_end, const std::function<void(const State&)>& accepted);

  const StepCounts& counts() const { return counts_; }

 private:
  bool try_step(State& x, double h);
  bool newton(State& x, double h);
  void factorize(const State& x, const Constraints& c, const Weights& w, double scale);

  Model& model_;
  AlphaSettings settings_;
  double alpha_m_, alpha_f_, beta_, gamma_;
  StepCounts counts_;
  UnsymmetricSolver solver_;
  SparseMatrix kkt_;
  int analysed_version_ = -1;
  double factored_h_ = 0;  // step the kept factorization belongs to; 0: none
  VectorXd scales_;        // displacement per unit of each unknown
  double size_ = 1;        // of the model [m]
  int scaled_version_ = -1;
  Constraints constraints_;
  VectorXd residual_, right_, solution_;
  std::string history_;  // of the residuals of the last failed step
};

}  // namespace flexmorph::fem
