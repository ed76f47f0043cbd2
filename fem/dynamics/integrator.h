#pragma once

#include <functional>
#include <memory>
#include <string>

#include "fem/model.h"

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

struct IntegratorSettings {
  std::string name = "generalized_alpha";  ///< a row of the table of make_integrator()
  AlphaSettings alpha;
  EnergyMomentumSettings energy_momentum;
};

/// What a time integration spent so far.
struct StepCounts {
  int steps = 0, newton = 0, factorizations = 0, rejected = 0;
};

/// The seam of time integration: advances the equations that a model states.
class Integrator {
 public:
  virtual ~Integrator() = default;

  /// Consistent q̈, λ from the twice differentiated constraints; the algorithmic acceleration is q̈.
  /// @throws Error (numerical) when the constraints are redundant.
  virtual void make_consistent(State& x) = 0;
  /// The same for velocities that miss Φ_q q̇ + Φ_t = 0 a little: the nearest in the mass norm.
  virtual void project_velocity(State& x) = 0;

  /// Advances x to t_end in one step; halves and retries where Newton fails, growing back later.
  /// `accepted` sees every accepted step, with the model prepared for its time.
  /// @throws Error (numerical) naming time, step and the residual history; x is the last good
  /// state.
  virtual void advance(State& x, double t_end,
                       const std::function<void(const State&)>& accepted) = 0;

  /// The state in the middle of the last accepted step, of an integrator whose multipliers and
  /// accelerations belong there (and are those of the accepted state as well, which has none of its
  /// own until make_consistent()); null where they belong to the end.
  virtual const State* step_mean() const { return nullptr; }

  virtual const StepCounts& counts() const = 0;
};

/// "generalized_alpha" or "energy_momentum". The model must outlive the integrator.
/// @throws Error (input) naming the known integrators, or for settings that make no sense.
std::unique_ptr<Integrator> make_integrator(Model& model, const IntegratorSettings& settings);

}  // namespace flexmorph::fem
