#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "fem/dynamics/mesh_changes/mesh_map.h"
#include "fem/model/workspace.h"
#include "geometry/archive.h"

namespace flexmorph::fem {

/// Settings of Newton's method in a time step, and of the halving of steps that fail.
struct StepSettings {
  /// Tolerance of the last correction, relative to the size of the model or, for energy_momentum,
  /// to the displacement of the step if this is smaller.
  double tolerance = 1e-11;
  /// Largest number of Newton iterations before the step is halved.
  int max_iterations = 12;
  /// Largest number of halvings of a step before the integration fails.
  int max_halvings = 10;
};

/// Settings of the integrator generalized_alpha.
struct AlphaSettings : StepSettings {
  double rho_inf = 0.8;  ///< Spectral radius at infinite frequency, 0 to 1.
};

/// Settings of the integrator energy_momentum. It conserves energy and momenta as accurately as its
/// equations are solved; therefore the default tolerance is at round-off.
struct EnergyMomentumSettings : StepSettings {
  EnergyMomentumSettings() { tolerance = 1e-14; }
};

/// Settings of the integrator minimal_coordinates.
struct MinimalCoordinatesSettings {
  /// Error tolerance of a step, in [1e-13, 1): for positions relative to the size of the model, for
  /// velocities relative to the largest speed.
  double tolerance = 1e-8;
  /// Largest number of accepted and rejected steps in one advance(); a model that needs more is
  /// stiff.
  int max_steps = 100'000;
};

/// Name of an integrator and the settings of all integrators.
struct IntegratorSettings {
  std::string name = "generalized_alpha";  ///< Name of the integrator, see make_integrator().
  AlphaSettings alpha;                     ///< Settings of generalized_alpha.
  EnergyMomentumSettings energy_momentum;  ///< Settings of energy_momentum.
  MinimalCoordinatesSettings minimal_coordinates;  ///< Settings of minimal_coordinates.
};

/// Statistics of a time integration since its start.
struct StepCounts {
  /// Numbers of accepted steps, of Newton iterations and of factorizations.
  int steps = 0, newton = 0, factorizations = 0;
  /// Number of rejected steps: Newton's method failed, or the error of an explicit step was too
  /// large.
  int rejected = 0;
  /// Number of steps of Integrator::try_step() whose local error was too large.
  int inaccurate = 0;
  /// Number of evaluations of the accelerations by explicit integrators.
  int evaluations = 0;
  /// Number of choices of independent coordinates.
  int partitions = 0;
};

/// Saves or restores the state of a model (geometry/archive.h).
void archive(Archive& memory, State& x);

/// Outcome of a step of Integrator::try_step().
struct TriedStep {
  /// True if Newton's method converged.
  bool converged = false;
  /// Estimate of the local error, relative to the size of the model.
  double error = 0;
  /// Number of Newton iterations. If the error is far below the allowed one, only the iterations
  /// since the first new tangent of the step are counted.
  int iterations = 0;
};

/// Interface of the time integrators, which advance the equations of motion of a model.
class Integrator {
 public:
  virtual ~Integrator() = default;

  /// Computes consistent q̈ and λ from the twice differentiated constraints. Variables of the scheme
  /// besides the state (the algorithmic acceleration of generalized-alpha) are set accordingly.
  /// @throws Error (numerical) if the constraints are redundant.
  virtual void make_consistent(State& x) = 0;
  /// Prepares the first step of a motion with steps of about h that are not adaptive, such that the
  /// multipliers follow a smooth solution from this step on.
  /// @param x  State after make_consistent().
  virtual void begin_motion([[maybe_unused]] const State& x, [[maybe_unused]] double h) {}
  /// Projects velocities that violate Φ_q q̇ + Φ_t = 0 slightly onto the constraints, with the
  /// smallest change in the mass norm.
  virtual void project_velocity(State& x) = 0;

  /// Continues after a discontinuity of drives or loads: the last step ended just before it, and
  /// x.t is now its time. Accelerations and multipliers jump to the values after the discontinuity,
  /// and the variables of the scheme besides the state jump with them.
  virtual void cross_discontinuity(State& x) { make_consistent(x); }

  /// Restores the balance of forces after a change of the mesh by balance_forces().
  /// @returns the change of the accelerations (n_dofs)
  virtual VectorXd balance(State& x, double frequency) = 0;

  /// Transfers the variables of the scheme besides the state across a change of the mesh, after
  /// `map` and balance_forces() have transferred the state.
  /// @param before  State before the change.
  /// @param change  Change of the accelerations by balance_forces() (n_dofs).
  virtual void change_mesh([[maybe_unused]] const MeshMap& map,
                           [[maybe_unused]] const State& before,
                           [[maybe_unused]] const VectorXd& change) {}

  /// Advances x to t_end: in one step, which is halved and repeated if Newton's method fails and
  /// grows again later, or in as many steps as the tolerance of the integrator requires.
  /// @param accepted  Function that is called after every accepted step.
  /// @throws Error (numerical) naming time, step and the history of the residuals; x is then the
  /// last valid state.
  virtual void advance(State& x, double t_end,
                       const std::function<void(const State&)>& accepted) = 0;

  /// Tries one step from x to x.t + h. x becomes the end of the step if Newton's method converges
  /// and the estimated local error is not above `allowed`; otherwise x does not change.
  /// @throws Error (numerical) if Newton's method has failed in more consecutive tries than
  ///         StepSettings::max_halvings; Error (input) from an integrator without error estimate.
  virtual TriedStep try_step(State& x, double h, double allowed);
  /// Returns the length of a first step from the consistent state x with a local error of about
  /// `allowed`, at most `longest`; to be called before the first try_step().
  virtual double first_step(const State& x, double allowed, double longest);

  /// Returns the state in the middle of the last accepted step if the multipliers and accelerations
  /// of the integrator belong to this state; null if they belong to the end of the step. In the
  /// first case the accepted state has the mean multipliers and accelerations, too, until
  /// make_consistent().
  virtual const State* step_mean() const { return nullptr; }

  /// Returns the statistics of the integration.
  virtual const StepCounts& counts() const = 0;
  /// Saves or restores, between two steps, the data besides the state on which the next steps
  /// depend. If they are restored into an integrator with the same settings and model (and mesh),
  /// the next steps are bit for bit the same.
  virtual void archive(Archive& memory) = 0;
  /// Returns condition_estimate() of the matrix that was factored last; nothing if there is none.
  /// Costs a factorization.
  virtual std::optional<double> condition() const = 0;
};

/// Creates the integrator "generalized_alpha", "energy_momentum" or "minimal_coordinates". The work
/// space must outlive the integrator.
/// @throws Error (input) naming the known integrators, or if the settings are invalid.
std::unique_ptr<Integrator> make_integrator(Workspace& model, const IntegratorSettings& settings);

}  // namespace flexmorph::fem
