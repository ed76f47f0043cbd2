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

/// The shelf of joints: all that the program knows of a kind of [[joint]] stands in one file of
/// this folder, and table.cpp lists it.
namespace flexmorph::cases {

/// What the maker of a joint may ask of the model that it becomes part of.
struct JointParts {
  const Scene& scene;
  bool rigid = false;         ///< in the rigid kinematic model, where plates and beams do not bend
  fem::MarkerPlace a{}, b{};  ///< of joints between bodies: both places, found in the model
  double angle_a = 0, angle_b = 0;  ///< of their first axes at the start, in the world [rad]
  /// Place of a material point of the joint's body, in the model; and in the world at the start
  /// [m].
  std::function<fem::MarkerPlace(const Vec2& material)> place{};
  std::function<Vec3(const Vec2& material)> start{};

  /// The laws of a joint.
  std::function<fem::Motion(double)> law(const Joint& joint, size_t i) const {
    return scene.motion_of(joint.laws[i]);
  }
};

/// A row of the table of joints.
struct JointRow {
  const char* name;      ///< as cases say it: type = "revolute"
  const char* sentence;  ///< what it does
  /// Reads the keys of its entry, and checks that it fits to what the scene has so far.
  /// @throws Error (input) located in the file
  void (*read)(const io::Table& t, const Scene& scene, Joint& joint);
  /// The joint of the model, or nothing where the model does not need it (in the rigid kinematic
  /// model no lines move). Edges in hubs, in sleeves and on rigid bodies are made by those who know
  /// how plates grow (assembly/mechanism.cpp), held edges from `held`: they have no maker.
  std::unique_ptr<fem::Joint> (*make)(const Joint& joint, const JointParts& parts) = nullptr;
  /// What it holds at one edge of a plate in space.
  std::vector<fem::Held> (*held)(const Joint& joint, const std::string& edge) = nullptr;
  /// What its first law prescribes, as the frames of its two places say it: a drive that follows
  /// from a trajectory is found that way.
  fem::JointCoordinate coordinate = nullptr;

  bool drives_angle = false;  ///< its laws are angles [rad], not lengths or coordinates [m]
  bool on_one_body = false;   ///< it acts on place a alone; its columns are of that body
  bool holds_point = false;   ///< stresses of a plate are singular where it holds a material point
  /// What can be other than zero in its columns `force_x`, `force_y` and `moment`, and is drawn.
  bool has_force = true, has_moment = false;
};

/// All rows, in the order in which messages list them.
std::span<const JointRow* const> joint_rows();
/// Returns the row of this name; null where there is none.
const JointRow* find_joint(std::string_view name);
/// Adds a row, see Registry::add(). Keys that it reads are declared with io::key().
void register_joint(const JointRow& row);

}  // namespace flexmorph::cases
