#pragma once

#include <limits>
#include <optional>
#include <string>

#include "fem/solve/statics.h"

/// [time] and [static].
namespace flexmorph::cases {

/// How a driven scene starts (fem/README.md, Starts).
enum class Start {
  automatic,     ///< equilibrium at rest where nothing moves at the start, else steady
  prestretched,  ///< velocity of the rigid, extending body, in equilibrium in the turning frame:
                 ///< in hubs under -ω² x alone
  steady,      ///< in equilibrium under all inertia forces of the rigid motion, and moving with it
  rigid,       ///< the same velocity, unstrained: sets off axial ringing
  hub_at_rest  ///< smooth spin-up of the hub from rest
};

/// Steps of a motion or a path are counted in an int.
constexpr double kMostSteps = std::numeric_limits<int>::max();

struct TimeSpan {
  double end = 1;      ///< [s], from 0
  double step = 1e-3;  ///< [s]; not of adaptive steps
  /// Steps that adapt to this tolerance (fem::AdaptiveStep); absent: equal ones.
  std::optional<double> tolerance;
  double largest_step = 0;                       ///< of adaptive steps [s]; 0: the default
  std::string integrator = "generalized_alpha";  ///< see fem::make_integrator()
  double explicit_tolerance = 1e-8;              ///< of the steps of `minimal_coordinates`
  double rho_inf = 0.8;  ///< spectral radius of generalized-alpha at infinite frequency, 0..1
  Start start = Start::automatic;
  double spin_up = 0;  ///< duration of the spin-up [s], 0 unless `hub_at_rest`
};

/// Nonlinear statics of the bodies, in place of a motion.
struct StaticAnalysis {
  fem::StaticSettings::Path path = fem::StaticSettings::Path::load;
  double to = 1;            ///< load factor at the end, from 0
  int steps = 10;           ///< equal steps to there; arc_length: the first step is one of them
  int max_steps = 1000;     ///< equilibria before the analysis gives up
  int max_iterations = 15;  ///< of Newton's method in a step
  /// What the load factor multiplies; the other one is there as it is from the start.
  bool loads_grow = true, temperatures_grow = false;
};

}  // namespace flexmorph::cases
