#pragma once

#include <functional>
#include <optional>
#include <span>

#include "fem/model/workspace.h"

namespace flexmorph::fem {

/// Equilibrium of a model in a steadily rotating frame by Newton's method with exact tangent:
///
///   F(q) - M ω² (q - center) + Φ_qᵀ λ = 0,   Φ(q, x.t) = 0
///
/// @param spin    ω² of every unknown (n_dofs) [1/s²]: zero gives plain statics
/// @param center  what the centrifugal acceleration is taken from (n_dofs) [m]
/// @param x       in: start of the iteration; out: q and λ of the equilibrium
/// @throws Error (numerical) when Newton does not converge in 40 iterations.
void solve_rotating_equilibrium(Workspace& model, const VectorXd& spin, const VectorXd& center,
                                State& x);

/// Equilibrium under the inertia forces of a motion that is known: F(q, v, a) + Φ_qᵀ λ = 0,
/// Φ(q, x.t) = 0 for q and λ with v and a as they are (d'Alembert). Rates of material lines count.
/// @throws Error (numerical) likewise.
void solve_carried_equilibrium(Workspace& model, State& x);

/// How a body turns: angular velocity [rad/s] and angular acceleration [rad/s²].
struct Turning {
  double rate = 0, acceleration = 0;
};

/// Equilibrium of bodies that are carried along, inertia taken where the strained bodies are: with
/// u = q - q_R, the unknowns less those of the rigid motion,
///
///   F(q, q̇, q̈) + Φ_qᵀ λ = 0,   Φ(q, x.t) = 0
///   q̇ = q̇_R + ω J u,   q̈ = q̈_R + (ω' J - ω² I) u,   J a quarter turn
///
/// for every vector of a body that turns with ω and ω': the displacements turn with the body. Where
/// Newton's method does not find it at once, the forces at x are brought on in steps.
///
/// @param turning  of every body of the model
/// @param x  in: the rigid motion q_R, q̇_R, q̈_R; out: the equilibrium, with its q̇ and q̈
/// @throws Error (numerical) when no equilibrium is found.
void solve_steady_equilibrium(Workspace& model, std::span<const Turning> turning, State& x);

/// Adds C ∂q̇/∂u + M ∂q̈/∂u of solve_steady_equilibrium() to a tangent with F_q alone.
/// @param kkt  of Workspace::kkt() with the weights {1, 0, 0} and scale 1
void add_turning_tangent(Workspace& model, const State& x, const Constraints& c,
                         std::span<const Turning> turning, SparseMatrix& kkt);

/// Static equilibrium of a model that joints leave free to move (a load that hangs): F(q, 0, 0) +
/// Φ_qᵀ λ = 0, Φ(q, x.t) = 0, by Newton's method near x.
///
/// Where nothing but weight brings a body back, the tangent is singular until λ is known; so the
/// model is held where it is by a force -κ M (q - q₀) that fades: κ falls from 10⁴ by a factor of
/// ten per iteration to 0.01 s⁻² and stays there. A freedom with frequency ω misses its
/// equilibrium by 0.01/ω² of what it moved; one that nothing brings back stays where it is.
///
/// Where it does not converge, the forces at x are brought on in steps, each held by the
/// equilibrium before it: a spring that is far from its free length, or wound up by turns.
///
/// @param x  in: near the equilibrium; out: q and λ of it, v = a = 0.
/// @throws Error (numerical) when no equilibrium is found, or a body leaves by 100 sizes of the
///         model.
void solve_resting_equilibrium(Workspace& model, State& x);
/// κ of its last iterations [1/s²].
inline constexpr double kLastHold = 1e-2;

/// Small displacements of a linear analysis: one Newton step from x under the loads as they are
/// (n_dofs). x is an equilibrium without loads, for instance the reference.
/// @throws Error (numerical) when the tangent is singular.
VectorXd linear_displacement(Workspace& model, const State& x);

struct StaticSettings {
  enum class Path {
    load,       ///< the load factor grows step by step
    arc_length  ///< displacements and load factor together: passes limit points, snaps through
  };
  Path path = Path::load;
  double from = 0, to = 1;      ///< load factor at the start and at the end
  double first_step = 0.1;      ///< part of |to - from|
  double largest_step = 0.25;   ///< likewise; along the arc: growth over its first step, times 10
  double smallest_step = 1e-6;  ///< likewise; below it the analysis gives up
  int max_iterations = 15;      ///< Newton, per step
  int easy_iterations = 5;      ///< steps that needed fewer let the next one grow
  int max_steps = 1000;
  /// Largest correction of the last iteration, in parts of the model's size, as a displacement.
  double tolerance = 1e-10;
  bool condition = false;  ///< estimate the condition at the end (costs a factorization)
};

/// An equilibrium on the path.
struct StaticStep {
  int number;
  double factor;
  int iterations;
  const State& x;
};
/// Sees every equilibrium; false ends the analysis there.
using StaticObserver = std::function<bool(const StaticStep&)>;

struct StaticResult {
  double factor = 0;  ///< of the last equilibrium
  int steps = 0, iterations = 0, rejected = 0;
  /// condition_estimate() of the tangent at the end, where it was asked for.
  std::optional<double> condition;
  bool completed = false;  ///< reached settings.to (and was not stopped by the observer)
};

/// Nonlinear statics along a path of equilibria,
///
///   F(q, μ) + Φ_qᵀ λ = 0,   Φ(q, x.t) = 0,   loads times the load factor μ  (Model::scale_loads;
///                                            in hot bodies the temperature is one of them),
///
/// by Newton's method with exact tangent. Steps are halved when it fails and grown when it is easy.
///
/// arc_length: Crisfield's spherical constraint on scaled displacements S Δq,
///
///   |S Δq|² / n + ψ² Δμ² = Δs²,   ψ = |S dq/dμ| / √n at the start,
///
/// the predictor goes on in the direction of the last step, and of the two roots the one is taken
/// whose step turns least. Ends where the factor first passes `to`.
///
/// Source: Crisfield (1981), Comput. Struct. 13, 55-62; Riks (1979), Int. J. Solids Struct. 15,
/// 529-551.
///
/// @param x  in: near the equilibrium at factor `from`; out: the last equilibrium; rates are zero.
///           The model's loads are left at its factor.
/// @throws Error (input) for settings that make no sense; Error (numerical) naming load factor and
/// residuals when steps became too small or too many: x is then the last equilibrium.
StaticResult solve_static(Workspace& model, State& x, const StaticSettings& settings = {},
                          const StaticObserver& observe = {});

}  // namespace flexmorph::fem
