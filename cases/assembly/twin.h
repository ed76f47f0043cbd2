#pragma once

#include <memory>

#include "cases/scene/scene.h"
#include "fem/dynamics/start.h"
#include "fem/solve/kinematics.h"

namespace flexmorph::cases {

/// The rigid twin of a scene in the plane: the same mechanism with rigid plates. It says how a
/// mechanism starts, how many freedoms it has, which loads its motion alone would bring (the rigid
/// motion q_R of P (29)), and what drives must do for a body to follow a path.
///
/// A plate becomes a rigid body whose origin is the middle of its free end and whose first axis is
/// the material axis: a root that material flows through moves along that axis.
class Twin {
 public:
  enum class Driven {
    by_drives,      ///< as the scene says
    by_trajectory,  ///< the trajectory's body is driven; drives that follow from it are let go
    free            ///< all drives of joints and of flows out of rigid bodies are let go
  };
  /// @throws Error (input) for joints that do not fit the bodies.
  explicit Twin(const Scene& scene, Driven driven = Driven::by_drives);

  fem::Workspace& model() { return model_; }
  const fem::Model& model() const { return model_; }
  const Scene& scene() const { return scene_; }

  /// Bodies where the case says they are, joints perhaps not yet met; at rest.
  fem::State guess() const;

  /// Frame of a plate's material point (X, 0), or of a rigid body, at a state of the twin.
  fem::FrameMotion frame(const std::string& body, const fem::State& x) const;

  /// The motion of a drive that follows from the trajectory, by what it drives.
  /// @throws Error (input) when no joint or flow uses the drive.
  fem::Motion motion_of(const std::string& drive, const fem::State& x) const;

 private:
  void add_plate(const Body& body);
  void add_carried(const Joint& joint);
  bool let_go(const Law& law) const;  ///< is its drive left out here?

  const Scene& scene_;
  Driven driven_;
  fem::Workspace model_;
};

/// Motion of a scene's twin in time. It starts with the velocities that the case gives.
///
/// Where plates and beams bend, joints may hold more than rigid ones have freedoms: the twin is
/// then indeterminate, and whether joints are independent is asked of the flexible model.
class TwinMotion {
 public:
  /// @throws Error (input) naming joints that contradict each other or, where nothing bends, hold
  /// the same freedom, and given velocities that contradict joints; Error (numerical) when the
  /// start cannot be assembled for another reason.
  explicit TwinMotion(const Scene& scene);

  int degrees_of_freedom() const { return freedoms_; }
  /// Do joints hold more than the rigid twin has freedoms?
  bool is_indeterminate() const { return indeterminate_; }
  /// Can drives lead the rigid twin to time t? Always, unless it is indeterminate.
  bool reaches(double t);
  /// At time t where drives determine it all; else at the start, whatever t.
  /// @throws Error (numerical) where that cannot be reached, with the time and the joints.
  const fem::State& at(double t);
  /// As at(), but goes no further once so many steps were taken in all. @return is it there?
  bool follow(double t, int most_steps);

  /// With freedoms left: largest speed of the bodies at the start [m/s], and their largest
  /// acceleration under weight, springs, drives and point masses [m/s²] (turning ones times a
  /// length of the body); from the joints' equations of motion. Loads on plates do not count.
  double start_speed() const;
  double start_acceleration();
  const Twin& twin() const { return twin_; }

 private:
  Twin twin_;
  int freedoms_ = 0;
  bool indeterminate_ = false;
  fem::State start_;
  std::unique_ptr<fem::Kinematics> kinematics_;
};

/// Freedoms of the mechanism whose drives are let go, see Twin::Driven::free.
int undriven_freedoms(const Scene& scene);

/// Refuses a mechanism that cannot go where its drives lead it: joints that depend on each other
/// at the start, and positions on the way that cannot be reached.
/// @throws Error as TwinMotion
void check_mechanism(const Scene& scene);

/// Fills the drives that follow from the scene's trajectory: twin driven along it, sampled, and
/// interpolated by quintics that have the value, rate and acceleration of the samples.
/// @throws Error (numerical) where the path cannot be reached, with the time; Error (input) for
/// drives that drive nothing and joints that contradict each other.
void follow_trajectory(Scene& scene);

}  // namespace flexmorph::cases
