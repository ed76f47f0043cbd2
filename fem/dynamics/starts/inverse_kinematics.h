#pragma once

#include "fem/dynamics/starts/rigid_kinematics.h"

namespace flexmorph::fem {

/// A prescribed motion of a rigid body in time.
struct RigidTrajectory {
  /// Name of the body.
  std::string body;
  /// Coordinates of the origin of the body [m] and its angle [rad] as functions of time [s].
  std::function<Motion(double t)> x, y, angle;
  /// End of the time interval, which begins at 0 [s].
  double end = 1;
};

/// Returns the motions of the named drives that move the body along its trajectory. For this
/// purpose the drives are released and the body is driven. The coordinates of the drives are
/// sampled at 2001 times and interpolated by quintics with the value, rate and acceleration of the
/// samples. Angles are continuous across 180 degrees.
/// @param drives  Names of the drives.
/// @throws Error (numerical) naming the time at which the path cannot be reached; Error (input) for
/// a drive without a coordinate, and for joints that contradict each other.
std::vector<std::function<Motion(double t)>> inverse_kinematics(
    RigidMechanism mechanism, const RigidTrajectory& trajectory,
    std::span<const std::string> drives);

}  // namespace flexmorph::fem
