#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fem/dynamics/starts/driven_frame.h"
#include "fem/material_reservoir.h"
#include "fem/rigid.h"
#include "fem/solve/diagnosis.h"

namespace flexmorph::fem {

/// A rigid body of a mechanism, or a plate or beam that is treated as rigid.
struct MechanismBody {
  /// Name of the body.
  std::string name;
  /// Mass, centre of mass and inertia of the body with everything that is fixed to it.
  RigidSection section;
  /// Length that converts a change of the body's axis into a displacement, such as its radius of
  /// gyration [m].
  double size = 1;
  /// Position of the body's axes at the start [m]; only a guess if joints determine it.
  Vec2 position{0, 0};
  /// Angle of the body's axes at the start [rad]; only a guess if joints determine it.
  double angle = 0;
  /// Velocity of the origin of the body's axes at the start, if it is given [m/s].
  std::optional<Vec2> velocity{};
  /// Angular velocity at the start, if it is given [rad/s].
  std::optional<double> angular_velocity{};
  /// Text with which messages about the body begin, such as "mill.toml:12: "; may be empty.
  std::string source{};
  /// Material coordinate X of a plate or beam at the origin of its axes [m].
  double line = 0;
  /// True if rigid_configuration() returns the body; false for a body that a hub carries (hub: the
  /// rigid frame with prescribed motion that carries a body).
  bool is_placed = true;
};

/// A function that returns the coordinate that a driven joint prescribes, from the motions of the
/// two frames a and b of the joint.
using JointCoordinate = Motion (*)(const FrameMotion& a, const FrameMotion& b);
/// Returns the angle from the first axis of a to that of b, within 180 degrees [rad].
Motion angle_between(const FrameMotion& a, const FrameMotion& b);
/// Returns the distance between the origins of a and b [m].
Motion distance_between(const FrameMotion& a, const FrameMotion& b);
/// Returns the coordinate of the origin of a along the first axis of a, relative to the origin of b
/// [m].
Motion distance_along(const FrameMotion& a, const FrameMotion& b);

/// A joint of a mechanism, with and without its drive.
struct MechanismJoint {
  /// The joint; empty as long as the motion of its drive is unknown.
  std::shared_ptr<const Joint> joint;
  /// True if a drive or a constant speed moves the joint.
  bool is_driven = false;
  /// A driven joint without its drive; empty if no constraint remains.
  std::shared_ptr<const Joint> released{};
  /// Name of the drive; empty if there is none.
  std::string drive{};
  /// True if the joint prescribes a coordinate, constant or in time; messages about many joints
  /// list these joints.
  bool prescribes = false;
  /// Coordinate that the drive prescribes; null if none is known.
  JointCoordinate coordinate = nullptr;
  /// Markers between which the coordinate is measured.
  MarkerLocation a{}, b{};
};

/// A mechanism of rigid bodies, as plain data. Copies share the joints and force elements, which
/// never change.
struct RigidMechanism {
  /// All bodies of the mechanism.
  std::vector<MechanismBody> bodies;
  /// All joints of the mechanism.
  std::vector<MechanismJoint> joints;
  /// Force elements: springs, and loads on bodies.
  std::vector<std::shared_ptr<const ForceElement>> force_elements{};
  /// Acceleration of gravity (2) [m/s²]; of size 0: there is no weight.
  LoadLaw gravity = LoadLaw(VectorXd());
  /// True if some bodies of the mechanism are flexible. Joints may then constrain more than the
  /// degrees of freedom of the rigid bodies.
  bool bends = false;
};

/// Adds a rigid body to a model, with its inertia, the inertia of its material reservoirs, its
/// weight and the unit length of its axis as a joint.
/// @param gravity  Acceleration of gravity (2) [m/s²], or of size 0.
/// @param reservoirs   Material reservoirs of the body.
/// @throws Error (input) as make_rigid_inertia() and the other functions that make its terms.
void add_rigid_body(Model& model, const MechanismBody& body, const LoadLaw& gravity,
                    std::span<const MaterialReservoir> reservoirs = {});

/// The rigid kinematic model of a planar mechanism. It determines the initial state of the
/// mechanism, its number of degrees of freedom, the loads of its rigid motion (q_R of P (29)), and
/// the motions of the drives for which a body follows a path. Copies are independent of each other.
///
/// A plate or beam becomes a rigid body whose origin is the middle of its free end and whose first
/// axis is the material axis. Therefore a root through which material flows moves along that axis.
class RigidKinematics {
 public:
  /// Creates the model of a mechanism.
  /// @throws Error (input) for joints that do not fit the bodies, and for a driven joint whose
  /// drive has no motion.
  explicit RigidKinematics(RigidMechanism mechanism);

  /// Returns the mechanism from which the model was created.
  const RigidMechanism& mechanism() const { return mechanism_; }
  /// Returns the work space of the rigid model.
  Workspace& model() { return model_; }
  /// Returns the work space of the rigid model.
  const Workspace& model() const { return model_; }

  /// Returns the state at zero velocity with all bodies at the positions of their data, which may
  /// violate the joints.
  State guess() const;
  /// Assembles a state (fem/solve/assembly.h). If the given positions do not lead to an assembled
  /// position, other starts are tried (other_start()), and remark() has a text about the position
  /// that was found.
  /// @returns false if assembled positions exist, but only flexible bodies can have velocities; all
  /// velocities are 0 then.
  /// @throws Error as assemble(); Error (input) as refusal() if joints contradict each other for
  /// all positions of the bodies.
  bool assemble(State& x);
  /// Returns a text about the position that assemble() has found from other starts; empty if the
  /// given positions led to an assembled position.
  const std::string& remark() const { return remark_; }
  /// Returns the error that names the joints that contradict each other or constrain a degree of
  /// freedom repeatedly. For many joints it also lists those that prescribe a coordinate,
  /// because they are the most likely cause.
  Error refusal(const Diagnosis& diagnosis) const;

  /// Returns the motion of the frame of a body at state x; for a plate or beam that of the frame at
  /// its material point (line, 0).
  FrameMotion frame(const std::string& body, const State& x) const;
  /// Returns the coordinate that a drive prescribes, with its rates, at state x.
  /// @throws Error (input) if no joint has a coordinate for this drive.
  Motion coordinate_of(const std::string& drive, const State& x) const;

 private:
  FrameMotion frame_at(const MarkerLocation& location, const State& x) const;
  bool assemble_elsewhere(const State& guess, State& x);

  RigidMechanism mechanism_;
  Workspace model_;
  std::string remark_;
};

/// Returns the mechanism with all driven joints released for which `chosen` returns true.
RigidMechanism released(RigidMechanism mechanism,
                        const std::function<bool(const MechanismJoint&)>& chosen);

/// Returns the number of degrees of freedom of the mechanism with all its driven joints released.
/// @throws Error (numerical) if this mechanism cannot be assembled.
int undriven_degrees_of_freedom(const RigidKinematics& kinematics);

/// Sets the velocities of an assembled state to the motion that has the given velocities of the
/// bodies and satisfies joints and drives. Among all such motions it is the one with the least
/// kinetic energy. A velocity that is absent differs from a velocity that is 0.
/// @param x  in: assembled positions; out: with velocities v.
/// @throws Error (input) naming the source of the body, the velocities, and the joints that
/// contradict them; Error (numerical) if the joints alone allow no velocity.
void give_initial_velocities(const RigidKinematics& kinematics, State& x);

}  // namespace flexmorph::fem
