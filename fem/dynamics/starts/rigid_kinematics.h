#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fem/dynamics/starts/carrier.h"
#include "fem/rigid.h"
#include "fem/solve/diagnosis.h"
#include "fem/stored.h"

namespace flexmorph::fem {

/// A rigid body of a mechanism, or a plate or beam of it that is taken as rigid.
struct MechanismBody {
  std::string name;
  RigidSection section;  ///< of all that is fixed to it
  double size = 1;       ///< makes its axis a displacement, such as its radius of gyration [m]
  Vec2 position{0, 0};   ///< of its axes at the start; a guess where joints say more [m]
  double angle = 0;      ///< of its axes at the start; likewise a guess [rad]
  std::optional<Vec2> velocity{};            ///< of its axes at the start, where given [m/s]
  std::optional<double> angular_velocity{};  ///< at the start, where given [rad/s]
  std::string source{};   ///< begins messages about it, such as "mill.toml:12: "; may be empty
  double line = 0;        ///< of a plate or beam: material coordinate X at its axes [m]
  bool is_placed = true;  ///< does rigid_configuration() list it? Not where it rides in a hub.
};

/// The coordinate that a driven joint prescribes, as a function of the frames of its two places.
using JointCoordinate = Motion (*)(const FrameMotion& a, const FrameMotion& b);
/// Returns the angle from the first axis of a to that of b, within half a turn [rad].
Motion angle_between(const FrameMotion& a, const FrameMotion& b);
/// Returns the distance of the origins [m].
Motion distance_between(const FrameMotion& a, const FrameMotion& b);
/// Returns the coordinate of the origin of a along its own first axis, as seen from the origin of b
/// [m].
Motion distance_along(const FrameMotion& a, const FrameMotion& b);

/// A joint of a mechanism, and what is left of it without its drive.
struct MechanismJoint {
  std::shared_ptr<const Joint> joint;       ///< empty while the motion of its drive is not known
  bool is_driven = false;                   ///< does a drive or a constant speed move it?
  std::shared_ptr<const Joint> released{};  ///< of a driven one: without the drive; empty: nothing
  std::string drive{};                      ///< name of its drive; empty where it has none
  /// Does it prescribe a coordinate, constant or in time? Messages about many joints name these.
  bool prescribes = false;
  JointCoordinate coordinate = nullptr;  ///< that its drive prescribes; null: none that is known
  MarkerPlace a{}, b{};                  ///< between which the coordinate is measured
};

/// A mechanism of rigid bodies, as plain data. A copy shares parts that never change.
struct RigidMechanism {
  std::vector<MechanismBody> bodies;
  std::vector<MechanismJoint> joints;
  std::vector<std::shared_ptr<const Link>> links{};  ///< springs, and loads on bodies
  LoadLaw gravity = LoadLaw(VectorXd());             ///< (2) [m/s²]; of size 0: nothing weighs
  /// Does it stand for a mechanism of which some bodies bend? Their joints may hold more than rigid
  /// bodies have freedoms.
  bool bends = false;
};

/// Adds a rigid body with its inertia, that of what it stores, its weight (gravity (2) [m/s²] or of
/// size 0) and its unit axis.
/// @throws Error (input) as make_rigid_inertia() and its like.
void add_rigid_body(Model& model, const MechanismBody& body, const LoadLaw& gravity,
                    std::span<const StoredMaterial> stored = {});

/// The rigid kinematic model of a planar mechanism. It says how the mechanism starts, how many
/// degrees of freedom it has, which loads its motion alone would bring (the rigid motion q_R of
/// P (29)), and what drives must do for a body to follow a path. It is a value: a copy shares
/// nothing that changes.
///
/// A plate or beam becomes a rigid body whose origin is the middle of its free end and whose first
/// axis is the material axis: a root that material flows through moves along that axis.
class RigidKinematics {
 public:
  /// @throws Error (input) for joints that do not fit the bodies, and for a joint whose drive has
  /// no motion.
  explicit RigidKinematics(RigidMechanism mechanism);

  const RigidMechanism& mechanism() const { return mechanism_; }
  Workspace& model() { return model_; }
  const Workspace& model() const { return model_; }

  /// Returns the state with all bodies where the data say they are, at rest; joints are perhaps not
  /// met yet.
  State guess() const;
  /// Assembles a state (fem/solve/assembly.h).
  /// @return false where there are positions, but only bodies that bend have velocities: all
  /// velocities are 0 then
  /// @throws Error as assemble(); Error (input) as refusal() where joints contradict each other
  /// wherever the bodies are.
  bool assemble(State& x);
  /// Returns the error that says which joints contradict each other or hold the same freedom, and
  /// of many joints which of them prescribe a coordinate: those are the ones to look at.
  Error refusal(const Diagnosis& diagnosis) const;

  /// Returns the frame of a body at a state: of a plate or beam at its material point (line, 0).
  FrameMotion frame(const std::string& body, const State& x) const;
  /// Returns the coordinate that a drive prescribes, as it is at a state.
  /// @throws Error (input) when no joint knows the coordinate of this drive.
  Motion coordinate_of(const std::string& drive, const State& x) const;

 private:
  FrameMotion frame_at(const MarkerPlace& place, const State& x) const;

  RigidMechanism mechanism_;
  Workspace model_;
};

/// Returns the mechanism with all joints released that are driven and for which `chosen` holds.
RigidMechanism released(RigidMechanism mechanism,
                        const std::function<bool(const MechanismJoint&)>& chosen);

/// Returns the degrees of freedom of the mechanism with all its driven joints released.
/// @throws Error (numerical) when it cannot be assembled.
int undriven_degrees_of_freedom(const RigidKinematics& kinematics);

/// Puts an assembled state into the motion that the given velocities of the bodies ask for: they
/// are kept, joints and drives are kept, and of all motions that do both it is the one of least
/// kinetic energy. A velocity that is absent differs from one that is 0.
/// @param x  in: positions that joints have; out: v as well
/// @throws Error (input) with the source of the body, the velocities and the joints that contradict
/// them; Error (numerical) where joints alone allow no velocity.
void give_initial_velocities(const RigidKinematics& kinematics, State& x);

}  // namespace flexmorph::fem
