#pragma once

#include "fem/dynamics/starts/rigid_kinematics.h"
#include "fem/dynamics/starts/start.h"
#include "fem/solve/kinematics.h"

namespace flexmorph::fem {

/// The motion of a rigid kinematic model in time. It starts with the given velocities of the
/// bodies.
///
/// If the mechanism has flexible bodies, its joints may constrain more than the degrees of freedom
/// of the rigid model. The rigid model is then indeterminate, and the independence of the joints
/// must be checked with the flexible model.
class RigidMotion {
 public:
  /// Creates the motion and assembles its initial state.
  /// @throws Error (input) naming joints that contradict each other or, without flexible bodies,
  /// depend on each other at the start only (dead centre), and for given velocities that contradict
  /// joints;
  /// Error (numerical) if the initial state cannot be assembled for another reason.
  explicit RigidMotion(RigidKinematics kinematics);
  RigidMotion(const RigidMotion&) = delete;
  RigidMotion& operator=(const RigidMotion&) = delete;

  /// Returns the number of degrees of freedom of the rigid model at the start.
  int degrees_of_freedom() const { return dofs_; }
  /// Returns true if joints constrain more than the degrees of freedom of the rigid model.
  bool is_indeterminate() const { return indeterminate_; }
  /// Returns true if drives can move the rigid model to time t; always true unless it is
  /// indeterminate.
  bool reaches(double t);
  /// Returns the state at time t if drives determine the motion completely; otherwise the initial
  /// state, for any t.
  /// @throws Error (numerical) naming the time and the joints if the state cannot be reached.
  const State& at(double t);
  /// Follows the motion to time t like at(), but stops when the total number of steps reaches
  /// max_steps.
  /// @returns true if time t was reached.
  bool follow(double t, int max_steps);

  /// Returns the largest speed of the bodies at the start [m/s]; an angular velocity counts times
  /// the size of the body.
  double start_speed() const;
  /// Returns the largest acceleration of the bodies at the start [m/s²] from the equations of
  /// motion with joints, under weight and all force elements; an angular acceleration counts times
  /// the size of the body.
  double start_acceleration();

  /// Returns the rigid kinematic model.
  const RigidKinematics& kinematics() const { return kinematics_; }

 private:
  RigidKinematics kinematics_;
  int dofs_ = 0;
  bool indeterminate_ = false;
  State start_;
  std::unique_ptr<Kinematics>
      driven_;  // only if drives determine the motion; refers to kinematics_
};

/// Checks that a mechanism can follow its drives: throws an error if joints contradict each other
/// at the start, or if a position before the time `end` [s] cannot be reached.
/// @throws Error as RigidMotion.
void require_motion(RigidKinematics kinematics, double end);

/// Returns a function that gives the motion of all bodies with MechanismBody::is_placed, which no
/// hub carries (hub: the rigid frame with prescribed motion that carries a body). Each copy of the
/// function has its own motion, which begins with its first call; therefore copies may be used at
/// the same time. The function throws the errors of RigidMotion.
BodyPoses rigid_configuration(RigidKinematics kinematics);

}  // namespace flexmorph::fem
