#pragma once

#include "fem/dynamics/integrators/step_solver.h"

namespace flexmorph::fem {

/// Coefficients of the scheme by its spectral radius at infinite frequency.
struct AlphaScheme {
  double alpha_m, alpha_f, beta, gamma;

  /// @throws Error (input) when rho is outside [0, 1].
  explicit AlphaScheme(double rho);
  /// Derivatives of (q, q̇, q̈) by q at the end of a step of size h.
  Weights weights(double h) const {
    return {1, gamma / (h * beta), (1 - alpha_m) / (h * h * beta * (1 - alpha_f))};
  }
};

/// The third derivative that the first step of a motion starts with.
struct StartJerk {
  double after = 0;  ///< s: jerk = (later.a - q̈_0) / s [s]
  State later;       ///< q_0 + s q̇_0 + ½ s² q̈_0, q̇_0 + s q̈_0, with consistent q̈ and λ
  VectorXd jerk, held;  ///< q⃛_0 and P q⃛_0; empty where it is not smooth
};

/// Generalized-alpha for index-3 equations of motion, Arnold & Brüls (2007).
///
///   (1 - α_m) a_{n+1} + α_m a_n = (1 - α_f) q̈_{n+1} + α_f q̈_n
///   q_{n+1} = q_n + h q̇_n + h² ((½ - β) a_n + β a_{n+1})
///   q̇_{n+1} = q̇_n + h ((1 - γ) a_n + γ a_{n+1})
///   M q̈ + F + Φ_qᵀ λ = 0,  Φ = 0   at t_{n+1} with the true q̈
///
///   α_m = (2ρ-1)/(ρ+1), α_f = ρ/(ρ+1), γ = ½ + α_f - α_m, β = (γ + ½)²/4
///
/// Steps that adapt (try_step()): where the motion is smooth, a_n = q̈(t_n + δ h) + O(h²) with
/// δ = α_m - α_f, as both sides of the first line say. So
///
///   - the position misses by  q_{n+1} - q(t_{n+1}) = -C h³ q⃛ + O(h⁴),  C = 1/6 - β - δ/2
///     = -(1/12 + δ²/4): from 1/12 (ρ = 1) to 1/3 (ρ = 0), never zero;  h³ q⃛ = h² (a_{n+1} - a_n).
///     Of frequencies that the step does not resolve, and of what constraints hold, that says
///     nothing: the estimate e is filtered as Newton's method would,
///         [ A  Φ_qᵀ ; Φ_q  0 ] (e, μ) = (A_M C h² (a_{n+1} - a_n), 0)
///     with the kept iteration matrix A and its part A_M of the mass: up to three times, and up to
///     eight times where e, filtered once, is below 0.3 of the tolerance: a vibration with an
///     amplitude below the tolerance misses by no more if nothing of it is right, while e would
///     ask for steps of a small part of its period.
///   - a step of another size h' starts from a_n + δ (h' - h) q⃛, and the first one from
///     q̈_0 + δ h q⃛_0. Where constraints hold the position, q_{n+1} is exact and the velocity misses
///     by C h² q⃛ instead: it starts with C (h'² - h²) q⃛ more (the first one with C h² q⃛_0) in
///     those directions, that is, of it what the filter takes away. Else the multipliers miss by
///     O(h) for a while after every change (as ρ^n n²).
///   - q⃛ is the mean of (a_{n+1} - a_n) / h over two steps: one alone contains the sign-changing
///     part of a, and steps of random sizes would feed it (unstable for ρ = 0.9).
///     Where that does not help, q⃛ is ringing that the step does not resolve: its sign says
///     nothing, and starts that follow it would feed it with every change of the step, until
///     Newton's method fails. A q⃛ that turns round from step to step is left alone.
///
/// Fixed steps (advance()) take no notice of their size but in the first step of a motion, which
/// begin_motion() prepares: it starts from a_0 = q̈_0 + δ h q⃛_0 and q̇_0 + C h² P q⃛_0, P q⃛_0 what
/// joints hold of q⃛_0: [M Φ_qᵀ; Φ_q 0] (P q⃛, μ) = (0, Φ_q q⃛). Without it multipliers miss by O(h)
/// for some 50 steps. q⃛_0 is the difference of consistent accelerations over a thousandth, a
/// hundredth or a tenth of the step, the first that hardly changes over the next one. It is not
/// used where all change (of ringing and round-off its sign says nothing), or where it changes over
/// a tenth of the step: stiff damping ends it within the step.
///
/// Source: Arnold, Brüls (2007), Multibody Syst. Dyn. 18, 185-202; fem/README.md, Time integration.
/// Start and error terms: Arnold, Brüls, Cardona (2015), Numer. Math. 129, 149-179; filter:
/// Shampine (1980) as in Hairer & Wanner (1996), Solving Ordinary Differential Equations II, IV.8.
class GeneralizedAlpha final : public StepSolver {
 public:
  /// @throws Error (input) when rho_inf is outside [0, 1].
  GeneralizedAlpha(Workspace& model, const AlphaSettings& settings);

  /// From q⃛_0 by a difference of consistent accelerations; the first step starts with it.
  double first_step(const State& x, double allowed, double longest) override;
  void begin_motion(const State& x, double h) override;
  /// What begin_motion() found, until the first step is made.
  const StartJerk& start_jerk() const { return start_; }
  /// δ: the algorithmic acceleration is that of the time t + δ h.
  double shift() const { return scheme_.alpha_m - scheme_.alpha_f; }
  /// The algorithmic acceleration that the next step starts from: q̈ after make_consistent(), else
  /// that of the last accepted step (n) [m/s²].
  const VectorXd& alpha() const { return alpha_; }
  void set_alpha(VectorXd alpha) { alpha_ = std::move(alpha); }
  /// The algorithmic acceleration stays as far from the true one as it was: it belongs to t + δ h.
  void cross_kink(State& x) override;
  void change_mesh(const MeshMap& map, const State& before, const VectorXd& change) override;
  void remember(Memory& memory) override;
  /// C: the local error of the position is -C h³ q⃛.
  double error_constant() const { return 1.0 / 6 - scheme_.beta - 0.5 * shift(); }

 private:
  void begin(const State& x, double h) override;
  double scale() const override { return scheme_.beta * h_ * h_; }
  void residual(VectorXd& force, VectorXd& constraint) override;
  void tangent(SparseMatrix& out) override;
  void correct(const VectorXd& dq, const VectorXd& dlambda) override;
  bool renew_tangent(const std::vector<char>& chosen, SparseMatrix& out) override;
  const VectorXd& iterate() const override { return next_.q; }
  double local_error(const State& x, double allowed) override;
  /// e becomes what Newton's method would make of A_M e, at the iterate.
  /// @param balance  the residual there; empty: zero
  void filter(VectorXd& e, const VectorXd& balance);
  void finish(State& x) override;
  void keep() override {
    alpha_.swap(next_alpha_);
    start_ = {};
  }
  void restart(const State& x) override {
    alpha_ = x.a;
    start_ = {};
  }
  /// The algorithmic acceleration at the end of the step, which belongs to the true one.
  void set_end_alpha(const State& x);
  /// Velocity and algorithmic acceleration that the step starts from.
  void set_start(const State& x);
  void keep_jerk();
  Weights weights() const { return scheme_.weights(h_); }

  AlphaScheme scheme_;
  double h_ = 0;
  VectorXd alpha_;                  // of the last accepted step
  State next_;                      // the iterate
  VectorXd next_alpha_;             // its algorithmic acceleration
  VectorXd start_v_, start_alpha_;  // as the step takes them
  StartJerk start_;                 // of the first step, where it does not adapt
  // Of steps that adapt: the size of the last one (0: none so far; negative: steps are fixed), q⃛
  // there, and the pattern of the model that q⃛ belongs to.
  double last_h_ = -1;
  VectorXd jerk_, step_jerk_;
  int jerk_version_ = -1;
  bool smooth_ = true;  // does q⃛ change little from step to step?
  VectorXd error_, change_, force_, kept_a_, balance_, miss_, none_, mu_;
  Constraints constraints_;
};

}  // namespace flexmorph::fem
