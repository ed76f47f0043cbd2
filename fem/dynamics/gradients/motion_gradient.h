#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "fem/dynamics/gradients/motion_measures.h"
#include "fem/dynamics/motion.h"

namespace flexmorph::fem {

/// Objective of a motion: the power mean of a measure m over times t_i,
///
///   J = (Σ w_i m(t_i)^p)^(1/p),   Σ w_i = 1.
struct MotionObjective {
  /// Choice of the times t_i and of their weights w_i.
  enum class Times {
    stops,  ///< The stops of the motion with equal weights; its end only if it is one of the stops.
    steps   ///< All steps, with the weights of the trapezoidal rule.
  };
  /// Measure whose mean is the objective.
  std::shared_ptr<const MotionMeasure> measure;
  /// Times at which the measure is evaluated.
  Times times = Times::steps;
  /// Exponent p, at least 1; the larger it is, the closer J is to the largest value.
  double exponent = 1;
};

/// A function that returns ψ · ∂F/∂p for a number p on which the forces F in M q̈ + F + Φ_qᵀ λ = 0
/// depend, for example a stiffness or a damping coefficient.
using ForceSlope = std::function<double(const State& x, const VectorXd& psi)>;

/// Settings of the gradient of a motion.
struct GradientSettings {
  /// Number of parts of the motion of which only one is stored at a time: each part is integrated a
  /// second time from the archive made at its start. 0: all states are stored, which takes four
  /// vectors of unknowns per step.
  int checkpoints = 0;
  /// Derivatives of the forces with respect to additional parameters.
  std::vector<ForceSlope> parameters;
  /// Callback at every step of the motion and of the adjoint; it may throw, for example to cancel
  /// the computation. Empty: it is not called.
  std::function<void()> every_step = {};
};

/// Value of an objective J and its derivatives.
struct MotionGradient {
  /// Value of J.
  double value = 0;
  /// Derivatives with respect to the scale factors of the cells of every body; empty for a body
  /// without design.
  std::vector<ScaleFactorGradient> d_factors;
  /// Derivatives with respect to GradientSettings::parameters.
  VectorXd by_parameters;
};

/// Gradients of all objectives of one motion, and the cost of their computation.
struct MotionGradients {
  /// Values and gradients of all objectives.
  std::vector<MotionGradient> of;
  /// Result of the motion, without its trajectory.
  MotionResult motion;
  /// CPU times of the motion and of the adjoint [s].
  double seconds_motion = 0, seconds_adjoint = 0;
  /// Numbers of factorizations and of iterations of the linear solver in the adjoint.
  int factorizations = 0, iterations = 0;
};

/// Integrates the motion of a model and returns the gradients of its objectives by the discrete
/// adjoint of the time steps. With z = (q, q̇, α, q̈, λ), step n is
///
///   R1 = q_n - q_{n-1} - h q̇_{n-1} - h² ((½ - β) α_{n-1} + β α_n)
///   R2 = q̇_n - q̇_{n-1} - h ((1 - γ) α_{n-1} + γ α_n)
///   R3 = (1 - α_m) α_n + α_m α_{n-1} - (1 - α_f) q̈_n - α_f q̈_{n-1}
///   R4 = M q̈_n + F(q_n, q̇_n, t_n) + Φ_qᵀ λ_n,   R5 = Φ(q_n, t_n)
///
/// All adjoint variables but those of R4 and R5 are eliminated. Then each step requires one solve
/// with the transposed iteration matrix of the step, backwards in time. The gradient includes all
/// operations on the states: the equilibria of the start, its consistent accelerations, changes of
/// the mesh (linear maps at times that do not depend on the design because the lines are
/// prescribed), projections of velocities, and steps that were cut. At the start and in
/// projections, derivatives of the constraints along the motion are differences of Φ_q of fourth
/// order.
///
/// The energy balance of the motion is not computed.
///
/// @throws Error (input) if the motion has no gradient (adaptive steps, integrators other than
///         generalized_alpha, free material lines, hot bodies, bodies in space, discontinuities),
///         if there is no objective or no measure, or if an exponent is below 1.
/// @throws Error (numerical) from the motion, or if the adjoint equations are singular.
///
/// Source: Callejo; Sonneville; Bauchau (2019), for a fixed mesh; fem/README.md, Gradients of a
/// motion.
MotionGradients motion_gradients(const Model& model, std::span<const MovingRoot> moving_roots,
                                 const MotionSettings& settings,
                                 std::span<const MotionObjective> objectives,
                                 const GradientSettings& gradient = {});

/// Integrates the motion of a model and returns the values J of its objectives, without gradients.
/// @param every_step  callback at every step, as GradientSettings::every_step
/// @throws Error as motion_gradients(); what the callback throws
std::vector<double> motion_values(const Model& model, std::span<const MovingRoot> moving_roots,
                                  const MotionSettings& settings,
                                  std::span<const MotionObjective> objectives,
                                  const std::function<void()>& every_step = {});

/// Returns the reason why a motion has no gradient, as text; empty if it has a gradient.
std::string no_gradient_because(const Model& model, const MotionSettings& settings);

}  // namespace flexmorph::fem
