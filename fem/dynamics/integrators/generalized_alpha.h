#pragma once

#include "fem/dynamics/integrators/step_solver.h"

namespace flexmorph::fem {

/// Coefficients of the generalized-alpha scheme for a given spectral radius at infinite frequency.
struct AlphaScheme {
  /// Coefficients α_m, α_f, β and γ.
  double alpha_m, alpha_f, beta, gamma;

  /// Computes the coefficients for the spectral radius rho.
  /// @throws Error (input) if rho is outside [0, 1].
  explicit AlphaScheme(double rho);
  /// Returns the derivatives of (q, q̇, q̈) with respect to q at the end of a step of size h.
  Weights weights(double h) const {
    return {1, gamma / (h * beta), (1 - alpha_m) / (h * h * beta * (1 - alpha_f))};
  }
};

/// Third derivative q⃛_0 of the positions at the start of a motion, which the first step uses.
struct StartJerk {
  /// Time difference s of the difference quotient jerk = (later.a - q̈_0) / s [s].
  double after = 0;
  /// State q_0 + s q̇_0 + ½ s² q̈_0, q̇_0 + s q̈_0, with consistent q̈ and λ.
  State later;
  /// Jerk q⃛_0 and its constrained component P q⃛_0; empty if the motion is not smooth.
  VectorXd jerk, held;
};

/// Generalized-alpha integrator for index-3 equations of motion, Arnold & Brüls (2007).
///
///   (1 - α_m) a_{n+1} + α_m a_n = (1 - α_f) q̈_{n+1} + α_f q̈_n
///   q_{n+1} = q_n + h q̇_n + h² ((½ - β) a_n + β a_{n+1})
///   q̇_{n+1} = q̇_n + h ((1 - γ) a_n + γ a_{n+1})
///   M q̈ + F + Φ_qᵀ λ = 0,  Φ = 0   at t_{n+1} with the true q̈
///
///   α_m = (2ρ-1)/(ρ+1), α_f = ρ/(ρ+1), γ = ½ + α_f - α_m, β = (γ + ½)²/4
///
/// Adaptive steps (try_step()): if the motion is smooth, a_n = q̈(t_n + δ h) + O(h²) with
/// δ = α_m - α_f, because both sides of the first equation then agree. Therefore:
///
///   - The error of the position is q_{n+1} - q(t_{n+1}) = -C h³ q⃛ + O(h⁴) with the constant
///     C = 1/6 - β - δ/2 = -(1/12 + δ²/4). The absolute value of C lies between 1/12 (ρ = 1) and
///     1/3 (ρ = 0) and is never zero. h³ q⃛ is estimated by h² (a_{n+1} - a_n). This estimate is
///     meaningless for frequencies that the step does not resolve and for directions that
///     constraints hold. Therefore the estimate e is filtered as Newton's method would do it,
///         [ A  Φ_qᵀ ; Φ_q  0 ] (e, μ) = (A_M C h² (a_{n+1} - a_n), 0),
///     with the kept iteration matrix A and its mass component A_M: up to three times, and up to
///     eight times if e, filtered once, is below 0.3 of the tolerance. A vibration with an
///     amplitude below the tolerance causes no larger error than this amplitude even if it is not
///     resolved at all, whereas e would require steps of a small fraction of its period.
///   - A step of another size h' starts from a_n + δ (h' - h) q⃛, and the first step starts from
///     q̈_0 + δ h q⃛_0. In directions that constraints hold, q_{n+1} is exact and the velocity has
///     the error C h² q⃛ instead. Therefore the term C (h'² - h²) q⃛ (in the first step C h² q⃛_0) is
///     added to the initial velocity in these directions, which are the component that the filter
///     removes. Without these terms the multipliers have errors of O(h) for some time after every
///     change of the step size (decaying as ρ^n n²).
///   - q⃛ is the mean of (a_{n+1} - a_n) / h over two steps. The value of a single step contains the
///     component of a with alternating sign, which steps of varying size would excite (unstable for
///     ρ = 0.9). If q⃛ is ringing that the step does not resolve, the mean does not help: its sign
///     is meaningless, and the terms above would excite the ringing with every change of the step
///     size until Newton's method fails. Therefore q⃛ is not used if it reverses from step to step.
///
/// Steps of constant size (advance()) use these terms only in the first step of a motion, which
/// begin_motion() prepares: it starts from a_0 = q̈_0 + δ h q⃛_0 and q̇_0 + C h² P q⃛_0, where P q⃛_0 is
/// the component of q⃛_0 that joints hold: [M Φ_qᵀ; Φ_q 0] (P q⃛, μ) = (0, Φ_q q⃛). Without them the
/// multipliers have errors of O(h) for about 50 steps. q⃛_0 is the difference of consistent
/// accelerations over a thousandth, a hundredth or a tenth of the step: over the first of these
/// intervals for which q⃛_0 hardly changes in the next interval of the same length. It is not used
/// if it changes in all three cases (of ringing and round-off, with a meaningless sign), or if it
/// changes over a tenth of the step (stiff damping then ends it within the step).
///
/// Source: Arnold, Brüls (2007), Multibody Syst. Dyn. 18, 185-202; fem/README.md, Time integration.
/// Start and error terms: Arnold, Brüls, Cardona (2015), Numer. Math. 129, 149-179; filter:
/// Shampine (1980) as in Hairer & Wanner (1996), Solving Ordinary Differential Equations II, IV.8.
class GeneralizedAlpha final : public StepSolver {
 public:
  /// Creates the integrator for a model, which must outlive it.
  /// @throws Error (input) if rho_inf is outside [0, 1], or if other settings are invalid.
  GeneralizedAlpha(Workspace& model, const AlphaSettings& settings);

  /// Returns the length of the first step from an estimate of q⃛_0, which is a difference of
  /// consistent accelerations and with which the first step starts.
  double first_step(const State& x, double allowed, double longest) override;
  void begin_motion(const State& x, double h) override;
  /// Returns the result of begin_motion(); it is empty after the first accepted step.
  const StartJerk& start_jerk() const { return start_; }
  /// Returns δ: the algorithmic acceleration at time t belongs to the time t + δ h.
  double shift() const { return scheme_.alpha_m - scheme_.alpha_f; }
  /// Returns the algorithmic acceleration from which the next step starts (n_dofs) [m/s²]: q̈ after
  /// make_consistent(), otherwise the one at the end of the last accepted step.
  const VectorXd& alpha() const { return alpha_; }
  /// Sets the algorithmic acceleration from which the next step starts (n_dofs) [m/s²].
  void set_alpha(VectorXd alpha) { alpha_ = std::move(alpha); }
  /// Keeps the difference between algorithmic and true acceleration, because the algorithmic one
  /// belongs to t + δ h.
  void cross_discontinuity(State& x) override;
  void change_mesh(const MeshMap& map, const State& before, const VectorXd& change) override;
  void archive(Archive& memory) override;
  /// Returns C: the local error of the position is -C h³ q⃛.
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
  /// Replaces e by the solution of Newton's method for the right side A_M e, at the iterate.
  /// @param balance  Residual at the iterate; empty: zero.
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
  /// Computes the algorithmic acceleration at the end of the step from the true acceleration.
  void set_end_alpha(const State& x);
  /// Computes the velocity and the algorithmic acceleration from which the step starts.
  void set_start(const State& x);
  /// Updates the estimate of q⃛ after an accepted step of adaptive size.
  void keep_jerk();
  Weights weights() const { return scheme_.weights(h_); }

  AlphaScheme scheme_;
  double h_ = 0;
  VectorXd alpha_;                  // at the end of the last accepted step
  State next_;                      // the iterate
  VectorXd next_alpha_;             // its algorithmic acceleration
  VectorXd start_v_, start_alpha_;  // initial values of the step
  StartJerk start_;                 // for the first step of constant size
  // Only for adaptive steps: the size of the last step (0: none so far; negative: steps are not
  // adaptive), q⃛ of this step, and the pattern version of the model to which q⃛ belongs.
  double last_h_ = -1;
  VectorXd jerk_, step_jerk_;
  int jerk_version_ = -1;
  bool smooth_ = true;  // true if q⃛ does not reverse from step to step
  VectorXd error_, change_, force_, kept_a_, balance_, miss_, none_, mu_;
  Constraints constraints_;
};

}  // namespace flexmorph::fem
