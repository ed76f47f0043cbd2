#pragma once

#include "fem/dynamics/growth.h"

namespace flexmorph::fem {

/// Starts of driven scenes (design.md section 4).
enum class Start {
  rigid,        ///< undeformed, every material point with the velocity of the rigid, extending body
  prestretched  ///< the same plus static equilibrium in the rotating frame: no axial ringing
};

/// Positions and velocities at time t of a model whose bodies ride in hubs. Accelerations and
/// multipliers are left zero: Integrator::make_consistent() finds them.
///
/// @throws Error (numerical) when the static equilibrium is not found.
State start_state(Model& model, std::span<const Growth> growths, double t, Start start);

}  // namespace flexmorph::fem
