#pragma once

#include <string>
#include <vector>

#include "cases/scene/drive.h"
#include "cases/scene/rigid_body.h"
#include "fem/joint.h"

/// [[joint]].
namespace flexmorph::cases {

/// A row of the table of joints, and what it needs:
///
/// weld        edge ("root" or "line 3") in the hub `to`, or edge ("free_end", too) on the rigid
///             body b; without an edge: axes of the rigid bodies a and b
/// revolute    points a and b are one
/// slider      point b slides along the first axis of a, axes are parallel
/// angle_drive, distance, point_drive   see fem/body_joints.h, by the laws
/// sleeve      edge in a frame at rest at `position`, `angle`: material slides through a free line
/// pin         the material point keeps `components` of its position at the start
/// clamp, support, symmetry    `edges` of a body in space, see fem::clamped_edge()
/// line_drive  the free line moves through the material at `speed`, or stands where `at` says
struct Joint {
  std::string type, body;
  std::string name;    ///< as messages and tables say it
  bool named = false;  ///< by the case: its forces are in the table of the motion
  Anchor a, b;         ///< of joints between bodies
  std::vector<Law> laws;
  std::string edge;
  std::string to;
  fem::WeldMode mode = fem::WeldMode::edge;
  Vec2 position{0, 0};  ///< [m]
  double angle = 0;     ///< [rad]
  Vec2 point{0, 0};     ///< material [m]
  std::vector<int> components;
  std::vector<std::string> edges;
  int line = 0;      ///< of line_drive; of weld and sleeve the line of their edge
  double speed = 0;  ///< [m/s]
  Law at;            ///< the drive of a line, if any

  /// Is an edge of a plate in a hub, in a sleeve or on a rigid body?
  bool holds_frame() const { return (type == "weld" && !body.empty()) || type == "sleeve"; }
  bool on_rigid_body() const { return holds_frame() && !b.on_ground(); }
  bool between_bodies() const { return !holds_frame() && (!a.on_ground() || !b.on_ground()); }
  bool holds_edges() const { return type == "clamp" || type == "support" || type == "symmetry"; }
};

}  // namespace flexmorph::cases
