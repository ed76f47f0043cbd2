#pragma once

#include "fem/dynamics/starts/rigid_kinematics.h"

namespace flexmorph::fem {

/// The path of a rigid body in time: its origin [m] and its angle [rad].
struct RigidTrajectory {
  std::string body;
  std::function<Motion(double t)> x, y, angle;
  double end = 1;  ///< of the time that is asked for [s]
};

/// Returns the motion of every named drive that leads the body along its trajectory: the drives are
/// released, the body is driven, and the coordinates of the drives are sampled at 2001 times and
/// interpolated by quintics that have the value, rate and acceleration of the samples. Angles are
/// continuous over half turns.
/// @throws Error (numerical) where the path cannot be reached, with the time; Error (input) for
/// drives that drive nothing and joints that contradict each other.
std::vector<std::function<Motion(double t)>> inverse_kinematics(
    RigidMechanism mechanism, const RigidTrajectory& trajectory,
    std::span<const std::string> drives);

}  // namespace flexmorph::fem
