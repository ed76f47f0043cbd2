#pragma once

#include <functional>
#include <optional>
#include <span>

#include "fem/model/workspace.h"

namespace flexmorph::fem {

/// Finds the equilibrium of a model in a steadily rotating frame by Newton's method with exact
/// tangent:
///
///   F(q) - M ω² (q - center) + Φ_qᵀ λ = 0,   Φ(q, x.t) = 0
///
/// @param spin  ω² of every unknown (n_dofs) [1/s²]: zero gives plain statics
/// @param center  centre from which the centrifugal acceleration is computed (n_dofs) [m]
/// @param x  in: start of the iteration; out: q and λ of the equilibrium
/// @throws Error (numerical) when Newton's method does not converge in 40 iterations.
void solve_rotating_equilibrium(Workspace& model, const VectorXd& spin, const VectorXd& center,
                                State& x);

/// Finds the equilibrium under the inertia forces of a given motion (d'Alembert): F(q, v, a) + Φ_qᵀ
/// λ = 0, Φ(q, x.t) = 0 for q and λ with v and a unchanged. Rates of material lines contribute.
/// @throws Error (numerical) when Newton's method does not converge in 40 iterations.
void solve_carried_equilibrium(Workspace& model, State& x);

/// Rotation of a body about the out-of-plane axis.
struct Turning {
  /// Angular velocity [rad/s] and angular acceleration [rad/s²].
  double rate = 0, acceleration = 0;
};

/// Finds the equilibrium of bodies that move with their frames, with inertia forces evaluated at
/// the deformed positions. With u = q - q_R, the unknowns minus those of the rigid motion,
///
///   F(q, q̇, q̈) + Φ_qᵀ λ = 0,   Φ(q, x.t) = 0
///   q̇ = q̇_R + ω J u,   q̈ = q̈_R + (ω' J - ω² I) u,   J a rotation by 90 degrees
///
/// for every vector of a body that rotates with ω and ω': the displacements rotate with the body.
/// Where Newton's method does not converge at once, the forces at x are applied in steps.
///
/// @param turning  rotation of every body of the model
/// @param x  in: the rigid motion q_R, q̇_R, q̈_R; out: the equilibrium, with its q̇ and q̈
/// @throws Error (numerical) when no equilibrium is found.
void solve_steady_equilibrium(Workspace& model, std::span<const Turning> turning, State& x);

/// Adds C ∂q̇/∂u + M ∂q̈/∂u of solve_steady_equilibrium() to a tangent that contains F_q only.
/// @param kkt  result of Workspace::kkt() with the weights {1, 0, 0} and scale 1
void add_turning_tangent(Workspace& model, const State& x, const Constraints& c,
                         std::span<const Turning> turning, SparseMatrix& kkt);

/// Finds the static equilibrium of a model with remaining degrees of freedom (a hanging load): F(q,
/// 0, 0) + Φ_qᵀ λ = 0, Φ(q, x.t) = 0, by Newton's method near x.
///
/// Where only the weight restores the position of a body, the tangent is singular until λ is known.
/// Therefore the model is held by a fading force -κ M (q - q₀): κ decreases from 10⁴ by a factor of
/// ten per iteration to 0.01 s⁻² and then stays constant. The remaining error of a degree of
/// freedom with angular frequency ω is 0.01/ω² of its displacement; a degree of freedom
/// without a restoring force stays where it is.
///
/// Where the iteration does not converge, the forces at x are applied in steps, each started from
/// the previous equilibrium. This serves a spring that is far from its free length, or wound up by
/// several turns.
///
/// @param x  in: near the equilibrium; out: q and λ of the equilibrium, v = a = 0.
/// @throws Error (numerical) when no equilibrium is found, or the unknowns move by more than 100
///     times the size of the model.
void solve_static_equilibrium(Workspace& model, State& x);
/// Holding coefficient κ of the last iterations of solve_static_equilibrium() [1/s²].
inline constexpr double kLastHold = 1e-2;

/// Returns the small displacements of a linear analysis (n_dofs): one Newton step from x under the
/// present loads. x is an equilibrium without loads, for instance the reference.
/// @throws Error (numerical) when the tangent is singular.
VectorXd linear_displacement(Workspace& model, const State& x);

/// Path, step sizes and tolerances of solve_static().
struct StaticSettings {
  /// Kind of path along which equilibria are followed.
  enum class Path {
    /// The load factor grows step by step.
    load,
    /// Displacements and load factor are followed together, which passes limit points and
    /// snap-through.
    arc_length
  };
  Path path = Path::load;   ///< Kind of path.
  double from = 0, to = 1;  ///< Load factors at the start and at the end.
  double first_step = 0.1;  ///< Size of the first step, as a fraction of |to - from|.
  /// Largest step as a fraction of |to - from|; along the arc the length may grow to 10 times the
  /// first length times largest_step / 0.25.
  double largest_step = 0.25;
  /// Step, as a fraction of |to - from|, below which the analysis ends with an error.
  double smallest_step = 1e-6;
  int max_iterations = 15;  ///< Largest number of Newton iterations per step.
  int easy_iterations = 5;  ///< Number of iterations up to which the next step grows.
  int max_steps = 1000;     ///< Largest number of steps, rejected ones included.
  /// Largest correction of the last iteration as a displacement, relative to the model's size.
  double tolerance = 1e-10;
  bool condition = false;  ///< True to estimate the condition at the end (one factorization).
};

/// An equilibrium on the path.
struct StaticStep {
  int number;      ///< Number of the step; 0 is the start.
  double factor;   ///< Load factor.
  int iterations;  ///< Number of Newton iterations of the step.
  const State& x;  ///< State at the equilibrium.
};
/// Function that is called at every equilibrium; the analysis stops when it returns false.
using StaticObserver = std::function<bool(const StaticStep&)>;

/// Outcome of a path of equilibria, see solve_static().
struct StaticResult {
  double factor = 0;  ///< Load factor of the last equilibrium.
  /// Numbers of accepted steps, of Newton iterations and of rejected steps.
  int steps = 0, iterations = 0, rejected = 0;
  /// Estimate of the condition of the tangent at the end, condition_estimate(), if requested.
  std::optional<double> condition;
  /// True if the load factor settings.to was reached and the observer did not stop the analysis.
  bool completed = false;
};

/// Follows a path of equilibria of nonlinear statics,
///
///   F(q, μ) + Φ_qᵀ λ = 0,   Φ(q, x.t) = 0,   loads times the load factor μ  (Model::scale_loads;
///                                            in heated bodies μ scales the temperature as well),
///
/// by Newton's method with exact tangent. Steps are halved when it fails and enlarged when it
/// converges quickly.
///
/// The path arc_length uses Crisfield's spherical constraint on scaled displacements S Δq,
///
///   |S Δq|² / n + ψ² Δμ² = Δs²,   ψ = |S dq/dμ| / √n at the start.
///
/// The predictor continues in the direction of the last step, and of the two roots the one is taken
/// whose step changes the direction least. The path ends where the factor first passes `to`.
///
/// Source: Crisfield (1981), Comput. Struct. 13, 55-62; Riks (1979), Int. J. Solids Struct. 15,
/// 529-551.
///
/// @param x  in: near the equilibrium at factor `from`; out: the last equilibrium; rates are zero.
///     The model's loads keep its factor.
/// @throws Error (input) for inconsistent settings; Error (numerical) naming load factor and
///     residuals when steps became too small or too many: x is then the last equilibrium.
StaticResult solve_static(Workspace& model, State& x, const StaticSettings& settings = {},
                          const StaticObserver& observe = {});

}  // namespace flexmorph::fem
