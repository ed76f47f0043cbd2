#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "fem/dynamics/mesh_changes/mesh_map.h"
#include "fem/model/workspace.h"
#include "geometry/memory.h"

namespace flexmorph::fem {

/// Newton's method in a time step, and what follows when it fails.
struct StepSettings {
  double tolerance = 1e-11;  ///< of the last correction, relative to the size of the model or (for
                             ///< energy_momentum) to the displacement of the step if less
  int max_iterations = 12;   ///< Newton iterations before the step is halved
  int max_halvings = 10;
};

struct AlphaSettings : StepSettings {
  double rho_inf = 0.8;  ///< spectral radius at infinite frequency, 0..1
};

/// Energy and momenta are kept as well as the equations are solved: to round-off by default.
struct EnergyMomentumSettings : StepSettings {
  EnergyMomentumSettings() { tolerance = 1e-14; }
};

struct MinimalCoordinatesSettings {
  /// Of a step: positions against the size of the model, velocities against the fastest; 1e-13..1.
  double tolerance = 1e-8;
  int max_steps = 100'000;  ///< accepted and rejected in one advance(): of more the scene is stiff
};

struct IntegratorSettings {
  std::string name = "generalized_alpha";  ///< a row of the table of make_integrator()
  AlphaSettings alpha;
  EnergyMomentumSettings energy_momentum;
  MinimalCoordinatesSettings minimal_coordinates;
};

/// What a time integration spent so far.
struct StepCounts {
  int steps = 0, newton = 0, factorizations = 0;
  int rejected = 0;     ///< steps that Newton's method did not solve
  int inaccurate = 0;   ///< steps of Integrator::try_step() whose local error was too large
  int evaluations = 0;  ///< of accelerations, by explicit integrators
  int partitions = 0;   ///< choices of independent coordinates
};

void remember(Memory& memory, State& x);

/// What became of a step of Integrator::try_step().
struct TriedStep {
  bool converged = false;
  double error = 0;    ///< estimate of the local error, relative to the size of the model
  int iterations = 0;  ///< of Newton's method; where the error is far below the allowed one
                       ///< only those since the first new tangent of the step
};

/// The seam of time integration: advances the equations that a model states.
class Integrator {
 public:
  virtual ~Integrator() = default;

  /// Consistent q̈, λ from the twice differentiated constraints. What the scheme carries besides the
  /// state (the algorithmic acceleration of generalized-alpha) starts from there.
  /// @throws Error (numerical) when the constraints are redundant.
  virtual void make_consistent(State& x) = 0;
  /// The motion begins at x, which make_consistent() has seen, with steps of about h that do not
  /// adapt: the first step starts so that multipliers are those of a smooth solution from then on.
  virtual void begin_motion(const State& /*x*/, double /*h*/) {}
  /// Moves velocities that miss Φ_q q̇ + Φ_t = 0 a little to the nearest in the mass norm.
  virtual void project_velocity(State& x) = 0;

  /// The last step ended just before a kink of drives or loads, x.t is its time now: accelerations
  /// and multipliers jump to those behind it, and what the scheme carries besides with them.
  virtual void cross_kink(State& x) { make_consistent(x); }

  /// Carries over what the scheme carries besides the state, which `map` and balance_forces() have
  /// taken across a change of the mesh.
  /// @param before  the state before the change
  /// @param change  of the accelerations by balance_forces() (n_dofs)
  virtual void change_mesh(const MeshMap& /*map*/, const State& /*before*/,
                           const VectorXd& /*change*/) {}

  /// Advances x to t_end: in one step, halved and retried where Newton fails, growing back later;
  /// or in as many as the tolerance of the integrator asks for.
  /// `accepted` sees every accepted step.
  /// @throws Error (numerical) naming time, step and the residual history; x is the last good
  /// state.
  virtual void advance(State& x, double t_end,
                       const std::function<void(const State&)>& accepted) = 0;

  /// Tries one step from x to x.t + h: x becomes its end where Newton's method converges and the
  /// estimated local error is not above `allowed`, else x stays what it is.
  /// @throws Error (numerical) when Newton's method failed in StepSettings::max_halvings tries in a
  ///         row; Error (input) from an integrator that knows no local error.
  virtual TriedStep try_step(State& x, double h, double allowed);
  /// Length of a first step from a consistent state whose local error is about `allowed`, at most
  /// `longest`; to be called before the first try_step().
  virtual double first_step(const State& x, double allowed, double longest);

  /// The state in the middle of the last accepted step, of an integrator whose multipliers and
  /// accelerations belong there (and are those of the accepted state as well, which has none of its
  /// own until make_consistent()); null where they belong to the end.
  virtual const State* step_mean() const { return nullptr; }

  virtual const StepCounts& counts() const = 0;
  /// What the next steps depend on besides the state, between two steps: put back into an
  /// integrator of the same settings and model, its mesh included, they are the same bit for bit.
  virtual void remember(Memory& memory) = 0;
  /// condition_estimate() of the matrix that was factored last; none before there is one. Costs a
  /// factorization.
  virtual std::optional<double> condition() const = 0;
};

/// "generalized_alpha", "energy_momentum" or "minimal_coordinates". The work space must outlive the
/// integrator.
/// @throws Error (input) naming the known integrators, or for settings that make no sense.
std::unique_ptr<Integrator> make_integrator(Workspace& model, const IntegratorSettings& settings);

}  // namespace flexmorph::fem
