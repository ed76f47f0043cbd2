#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cases/scene/joint.h"
#include "cases/scene/scene.h"
#include "fem/body_joints.h"
#include "fem/dynamics/starts/rigid_kinematics.h"

/// The table of joints: everything that is specific to one kind of [[joint]] is in one file of this
/// folder, and table.cpp lists all kinds.
namespace flexmorph::cases {

/// The data of a model under construction that JointRow::make() may use.
struct JointParts {
  const Scene& scene;  ///< Scene that is built.
  bool rigid = false;  ///< True in the rigid kinematic model (undeformed plates and beams).
  fem::MarkerLocation a{}, b{};  ///< Anchors of a joint between bodies, as locations in the model.
  double angle_a = 0, angle_b = 0;  ///< Angles of their first axes at the start [rad].

  /// Location of a material point of the joint's body in the model; for joints on one body.
  std::function<fem::MarkerLocation(const Vec2& material)> location{};
  /// Position of a material point of the joint's body at the start, in the world [m]; for joints on
  /// one body.
  std::function<Vec3(const Vec2& material)> start{};

  /// Returns the i-th law of a joint as a function of time.
  std::function<fem::Motion(double)> law(const Joint& joint, size_t i) const {
    return scene.motion_of(joint.laws[i]);
  }
};

/// A row of the table of joints.
struct JointRow {
  const char* name;      ///< Name in case files: type = "revolute".
  const char* sentence;  ///< Sentence that describes the joint.

  /// Reads the keys of a joint, and checks it against the joints and bodies read so far.
  /// @throws Error (input) located in the file
  void (*read)(const io::Table& t, const Scene& scene, Joint& joint);
  /// Creates the joint of the model, or null if the model does not need it: in the rigid kinematic
  /// model no lines move. It is null for joints without such a function: edges in hubs, in sleeves
  /// and on rigid bodies, which assembly/mechanism.cpp creates, and held edges, see `held`.
  std::unique_ptr<fem::Joint> (*make)(const Joint& joint, const JointParts& parts) = nullptr;
  /// Returns the vector components that are held at one edge of a plate in space.
  std::vector<fem::Held> (*held)(const Joint& joint, const std::string& edge) = nullptr;
  /// Coordinate that the first law prescribes, as a function of the frames at its two anchors.
  /// Inverse kinematics uses it to determine a drive that follows from a trajectory.
  fem::JointCoordinate coordinate = nullptr;

  bool drives_angle = false;  ///< True if its laws are angles [rad], not lengths [m].
  bool on_one_body = false;   ///< True if it acts on a alone; its columns then refer to that body.
  bool holds_point = false;   ///< True if it holds a material point of a plate (singular stress).

  /// True if it can transmit a force (a moment): its columns are then drawn.
  bool has_force = true, has_moment = false;
};

/// Returns all rows, in the order in which messages list them.
std::span<const JointRow* const> joint_rows();
/// Returns the row of this name; null where there is none.
const JointRow* find_joint(std::string_view name);
/// Adds a row to the table of joints, see Registry::add(). The row declares the keys that it reads
/// with io::key().
/// @throws Error (input) if the row lacks read(), or both of make() and held(), or for a name that
///         is taken
void register_joint(const JointRow& row);

}  // namespace flexmorph::cases
