#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "fem/dynamics/gradients/motion_measures.h"
#include "fem/dynamics/motion.h"

namespace flexmorph::fem {

/// The objective of a motion: the power mean of a measure over times t_i,
///
///   J = (Σ w_i m(t_i)^p)^(1/p),   Σ w_i = 1
struct MotionObjective {
  enum class Times {
    stops,  ///< those of the motion, all alike (without its end, where that is none of them)
    steps   ///< all steps, by the trapezoidal rule
  };
  std::shared_ptr<const MotionMeasure> measure;
  Times times = Times::steps;
  double exponent = 1;  ///< p; the larger, the nearer J is to the largest value
};

/// ψ · ∂F/∂p of M q̈ + F + Φ_qᵀ λ = 0 by a number p that forces depend on: a stiffness, a damping.
using ForceSlope = std::function<double(const State& x, const VectorXd& psi)>;

struct GradientSettings {
  /// Parts of the motion that are kept one at a time: each is gone through once more from what was
  /// taken down at its start. 0: all states are kept, which takes four vectors of unknowns a step.
  int checkpoints = 0;
  std::vector<ForceSlope> parameters;
};

/// J and its derivatives.
struct MotionGradient {
  double value = 0;
  std::vector<FactorSlopes> by_factors;  ///< of every body of the model; empty: it has no design
  VectorXd by_parameters;                ///< of GradientSettings::parameters
};

struct MotionGradients {
  std::vector<MotionGradient> of;                  ///< every objective
  MotionResult motion;                             ///< without its trajectory
  double seconds_motion = 0, seconds_adjoint = 0;  ///< CPU, of the motion and of all after it
  int factorizations = 0, iterations = 0;          ///< of the adjoint
};

/// Moves a model and derives what its motion comes to: the discrete adjoint of the steps as they
/// are made. With z = (q, q̇, α, q̈, λ), step n is
///
///   R1 = q_n - q_{n-1} - h q̇_{n-1} - h² ((½ - β) α_{n-1} + β α_n)
///   R2 = q̇_n - q̇_{n-1} - h ((1 - γ) α_{n-1} + γ α_n)
///   R3 = (1 - α_m) α_n + α_m α_{n-1} - (1 - α_f) q̈_n - α_f q̈_{n-1}
///   R4 = M q̈_n + F(q_n, q̇_n, t_n) + Φ_qᵀ λ_n,   R5 = Φ(q_n, t_n)
///
/// and eliminating all multipliers but those of R4 and R5 leaves, backwards in time, one solve with
/// the transposed iteration matrix of the step. Everything that happens to a state is derived with
/// it: the equilibria of the start, its consistent accelerations, changes of meshes (linear maps
/// whose times do not depend on the design, as lines are prescribed), projections of velocities,
/// steps that were cut. Constraints of the start and of projections are derived along the motion by
/// differences of Φ_q, of fourth order.
///
/// The balance of the motion is not kept.
///
/// @throws Error (input) for what has no derivative here: steps that adapt, other integrators,
///         free material lines, hot bodies, plates in space, kinks, no measure, an exponent
///         below 1.
/// @throws Error (numerical) from the motion, or where its equations are singular.
///
/// Source: Callejo; Sonneville; Bauchau (2019), for a fixed mesh; fem/README.md, Gradients of a
/// motion.
MotionGradients motion_gradients(const Model& model, std::span<const Growth> growths,
                                 const MotionSettings& settings,
                                 std::span<const MotionObjective> objectives,
                                 const GradientSettings& gradient = {});

/// J alone, of a motion that is made.
std::vector<double> motion_values(const Model& model, std::span<const Growth> growths,
                                  const MotionSettings& settings,
                                  std::span<const MotionObjective> objectives);

/// Why a motion has no gradient; empty: it has one.
std::string no_gradient_because(const Model& model, const MotionSettings& settings);

}  // namespace flexmorph::fem
