#pragma once

#include "fem/dynamics/mesh_changes/growth.h"

namespace flexmorph::fem {

/// Starts of driven scenes (fem/README.md, Starts).
enum class Start {
  rigid,  ///< undeformed, every material point with the velocity of the rigid, extending body
  prestretched,  ///< the same plus static equilibrium under the inertia forces of the rigid motion
                 ///< (in a hub under -ω² x alone: the hub turned, nothing flowed, before t = 0)
  steady,        ///< in equilibrium under all inertia forces of the rigid motion, flow, Euler and
           ///< Coriolis included, taken where the strained bodies are; velocities are those of that
           ///< shape, carried by the rigid motion and changing as it does
  at_rest,  ///< at rest, in static equilibrium, as exactly as forces bring bodies back
  settled   ///< at rest, near static equilibrium (see solve_resting_equilibrium()): for mechanisms
            ///< with freedoms that nothing drives
};

/// A body that rides in no hub, as a rigid one: rigid bodies, beams, and plates that other joints
/// hold.
struct Placed {
  std::string body;
  FrameMotion frame;
  double line = 0;  ///< of a plate or beam the coordinate X that lies at the frame's origin [m]
};

/// Where all such bodies of a mechanism are at a time, with rates and accelerations.
using Placement = std::function<std::vector<Placed>(double t)>;

/// Positions and velocities at time t of a model whose bodies ride in hubs or are placed.
/// Integrator
/// ::make_consistent() finds accelerations and multipliers.
///
/// @param placement  prestretched and steady: asked for a few times in [t, t + 2 δ]
/// @param delta  δ [s] of the difference that gives the rate of the strained shape; lines move
///        to t ± 2 δ for it, so that motions shorter than that need a smaller one
/// @throws Error (numerical) when the static equilibrium is not found.
State start_state(Workspace& model, std::span<const Growth> growths, double t, Start kind,
                  const Placement& placement = {}, double delta = 1e-4);

}  // namespace flexmorph::fem
