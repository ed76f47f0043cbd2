#pragma once

#include <limits>
#include <optional>
#include <string>

#include "fem/solve/statics.h"

/// The time span of a motion, [time], and the static analysis, [static].
namespace flexmorph::cases {

/// Initial state of a driven scene (fem/README.md, Starts). A hub is a rigid frame with prescribed
/// motion that carries a body.
enum class Start {
  /// Static equilibrium where all prescribed velocities are zero at the start, else `steady`.
  automatic,
  /// Velocities of the rigid, extending body, in equilibrium under the inertia forces of this
  /// motion; in hubs under the centrifugal acceleration -ω² x alone.
  prestretched,
  /// Equilibrium under all inertia forces of the rigid motion, with the velocities of this
  /// equilibrium.
  steady,
  /// Velocities of the rigid, extending body, unstrained; axial vibrations follow.
  rigid,
  /// Smooth spin-up of the hubs from zero angular velocity.
  hub_at_rest
};

/// Largest number of steps of a motion or a path; steps are counted in an int.
constexpr double kMaxSteps = std::numeric_limits<int>::max();

/// The time span and the time integration of a motion.
struct TimeSpan {
  double end = 1;                   ///< End of the run, which begins at 0 [s].
  double step = 1e-3;               ///< Time step [s]; not used with adaptive steps.
  std::optional<double> tolerance;  ///< Tolerance of fem::AdaptiveStep; absent: equal steps.
  double largest_step = 0;          ///< Limit of adaptive steps [s]; 0: the default.
  std::string integrator = "generalized_alpha";  ///< Name for fem::make_integrator().
  double explicit_tolerance = 1e-8;  ///< Tolerance of local errors of `minimal_coordinates`.
  double rho_inf = 0.8;  ///< Spectral radius of generalized-alpha at infinite frequency, 0..1.
  Start start = Start::automatic;  ///< Initial state.
  double spin_up = 0;              ///< Duration of the spin-up [s]; 0 unless `hub_at_rest`.
};

/// A nonlinear static analysis of the bodies, which takes the place of a motion.
struct StaticAnalysis {
  /// Path method: steps of the load factor, or steps along the arc length.
  fem::StaticSettings::Path path = fem::StaticSettings::Path::load;

  double to = 1;         ///< Load factor at the end of the path, which begins at 0 [-].
  int steps = 10;        ///< Number of equal steps; with arc_length it sizes the first step only.
  int max_steps = 1000;  ///< Number of equilibria after which the analysis fails.
  int max_iterations = 15;  ///< Limit of Newton iterations in a step.

  /// True if the load factor multiplies the loads (the temperatures). Loads or temperatures that it
  /// does not multiply act in full from the start.
  bool loads_grow = true, temperatures_grow = false;
};

}  // namespace flexmorph::cases
