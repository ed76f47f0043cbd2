#pragma once

#include <memory>

#include "cases/scene.h"
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
    by_drives,     ///< as the scene says
    by_trajectory  ///< the trajectory's body is driven; drives that follow from it are let go
  };
  /// @throws Error (input) for joints that do not fit the bodies.
  explicit Twin(const Scene& scene, Driven driven = Driven::by_drives);

  fem::Model& model() { return model_; }
  const Scene& scene() const { return scene_; }

  /// Bodies where the case says they are, joints perhaps not yet met; velocities as given.
  fem::State guess() const;

  /// Frame of a plate's material point (X, 0), or of a rigid body, at a state of the twin.
  fem::FrameMotion frame(const std::string& body, const fem::State& x) const;

  /// The motion of a drive that follows from the trajectory, by what it drives.
  /// @throws Error (input) when no joint or flow uses the drive.
  fem::Motion motion_of(const std::string& drive, const fem::State& x) const;

 private:
  void add_plate(const Body& body);
  void add_carried(const Joint& joint);
  bool follows(const Law& law) const;  ///< is it let go here?

  const Scene& scene_;
  Driven driven_;
  fem::Model model_;
};

/// Motion of a scene's twin in time.
class TwinMotion {
 public:
  explicit TwinMotion(const Scene& scene);

  int degrees_of_freedom() const { return freedoms_; }
  /// At time t where drives determine it all; else at the start only.
  const fem::State& at(double t);
  const Twin& twin() const { return twin_; }

 private:
  Twin twin_;
  int freedoms_ = 0;
  fem::State start_;
  std::unique_ptr<fem::Kinematics> kinematics_;
};

/// Fills the drives that follow from the scene's trajectory: twin driven along it, sampled, and
/// interpolated by quintics that have the value, rate and acceleration of the samples.
/// @throws Error (numerical) where the path cannot be reached, with the time.
void follow_trajectory(Scene& scene);

}  // namespace flexmorph::cases
