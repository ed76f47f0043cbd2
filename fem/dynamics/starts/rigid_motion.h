#pragma once

#include "fem/dynamics/starts/rigid_kinematics.h"
#include "fem/dynamics/starts/start.h"
#include "fem/solve/kinematics.h"

namespace flexmorph::fem {

/// The motion of a rigid kinematic model in time. It starts with the velocities that are given.
///
/// Where bodies bend, joints may hold more than rigid ones have freedoms: the rigid model is then
/// indeterminate, and whether joints are independent is asked of the flexible model.
class RigidMotion {
 public:
  /// @throws Error (input) naming joints that contradict each other or, where nothing bends, hold
  /// the same freedom, and given velocities that contradict joints; Error (numerical) when the
  /// start cannot be assembled for another reason.
  explicit RigidMotion(RigidKinematics kinematics);
  RigidMotion(const RigidMotion&) = delete;
  RigidMotion& operator=(const RigidMotion&) = delete;

  int degrees_of_freedom() const { return freedoms_; }
  /// Says whether joints hold more than the rigid model has freedoms.
  bool is_indeterminate() const { return indeterminate_; }
  /// Says whether drives can lead the rigid model to time t: always, unless it is indeterminate.
  bool reaches(double t);
  /// Returns the state at time t where drives determine it all; else that of the start, whatever t.
  /// @throws Error (numerical) where that cannot be reached, with the time and the joints.
  const State& at(double t);
  /// Goes to time t as at() does, but no further once so many steps were taken in all.
  /// @return is it there?
  bool follow(double t, int max_steps);

  /// Returns the largest speed of the bodies at the start [m/s]; turning counts times the size of
  /// the body.
  double start_speed() const;
  /// Returns the largest acceleration of the bodies at the start [m/s²] from the joints' equations
  /// of motion, under weight and all links; turning counts times the size of the body.
  double start_acceleration();

  const RigidKinematics& kinematics() const { return kinematics_; }

 private:
  RigidKinematics kinematics_;
  int freedoms_ = 0;
  bool indeterminate_ = false;
  State start_;
  std::unique_ptr<Kinematics> driven_;  // where drives determine it all; looks at kinematics_
};

/// Refuses a mechanism that cannot go where its drives lead it: joints that depend on each other at
/// the start, and positions on the way to the time `end` [s] that cannot be reached.
/// @throws Error as RigidMotion
void require_motion(RigidKinematics kinematics, double end);

/// Returns where the bodies of a mechanism are at a time that ride in no hub: those with
/// MechanismBody::is_placed. Every copy of it has a motion of its own, which begins when it is
/// asked for the first time: motions at the same time do not know of each other.
/// @throws Error as RigidMotion, when it is asked
Placement rigid_configuration(RigidKinematics kinematics);

}  // namespace flexmorph::fem
