#pragma once

#include "fem/dynamics/mesh_changes/moving_root.h"

namespace flexmorph::fem {

/// Kind of the initial state of a motion (fem/README.md, Starts). A hub is the rigid frame that
/// carries a body; its motion is prescribed, or it is fixed to a rigid body.
enum class Start {
  /// Undeformed; every material point has the velocity of the rigid, extending body.
  rigid,
  /// Motion of the rigid, extending body, and static equilibrium under the inertia forces of this
  /// motion. In a hub only -ω² x acts: before t = 0 the hub rotated, but no material flowed.
  prestretched,
  /// Equilibrium under all inertia forces of the rigid motion, including flow, Euler and Coriolis
  /// forces, evaluated at the strained bodies. The velocities are those of the strained shape,
  /// which moves and changes with the rigid motion.
  steady,
  /// Zero velocities and static equilibrium, as exact as the restoring forces allow.
  at_rest,
  /// Zero velocities, near static equilibrium (see solve_static_equilibrium()): for mechanisms
  /// with degrees of freedom that nothing drives.
  settled
};

/// Motion of a body that no hub carries, as a rigid body: a rigid body, a beam, or a plate that is
/// held by other joints.
struct BodyPose {
  std::string body;   ///< Name of the body.
  FrameMotion frame;  ///< Motion of the axes of the body.
  double line = 0;    ///< Coordinate X of a plate or beam at the origin of the axes [m].
};

/// A function that returns the motions of all bodies without hub at time t [s].
using BodyPoses = std::function<std::vector<BodyPose>(double t)>;

/// Returns positions and velocities at time t of a model whose bodies are carried by hubs or are
/// placed. Integrator::make_consistent() computes accelerations and multipliers afterwards.
///
/// @param moving_roots    Moving-root mesh control of the plates, with their hubs.
/// @param body_poses  Motion of the bodies without hub; evaluated at a few times in [t, t + 2 δ]
/// for
///                   the kinds prestretched and steady.
/// @param delta      Time difference δ [s] for the rate of the strained shape. Material lines are
/// moved
///                   to times up to t ± 2 δ; therefore shorter motions need a smaller δ.
/// @throws Error (numerical) if no static equilibrium is found.
State start_state(Workspace& model, std::span<const MovingRoot> moving_roots, double t, Start kind,
                  const BodyPoses& body_poses = {}, double delta = 1e-4);

}  // namespace flexmorph::fem
