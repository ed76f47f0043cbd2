#pragma once

#include <any>
#include <optional>
#include <string>
#include <vector>

#include "cases/scene/drive.h"
#include "cases/scene/rigid_body.h"
#include "fem/joint.h"

/// [[joint]].
namespace flexmorph::cases {

struct JointRow;

/// An entry of [[joint]]. What its fields mean depends on its row (joints/); a field that the row
/// does not read keeps its default.
struct Joint {
  const JointRow* row = nullptr;
  std::string body;    ///< of edges, lines and pins: the plate or beam
  std::string name;    ///< as messages and tables say it
  bool named = false;  ///< by the case: its forces are in the table of the motion
  Anchor a, b;         ///< of joints between bodies
  std::vector<Law> laws;
  std::string edge;
  std::string edge_a, edge_b;  ///< of a weld between plates and beams: the edges at a and b
  std::string to;
  fem::WeldMode mode = fem::WeldMode::edge;
  Vec2 position{0, 0};  ///< [m]
  double angle = 0;     ///< [rad]
  Vec2 point{0, 0};     ///< material [m]
  std::vector<int> components;
  std::vector<std::string> edges;
  int line = 0;  ///< that is driven, or the line of the edge
  bool drives_line = false;
  double speed = 0;  ///< [m/s]
  Law at;            ///< the drive of a line, if any
  std::any own;      ///< what only its row knows

  /// Is an edge of a plate in a hub, in a sleeve or on a rigid body?
  bool holds_frame() const { return !edge.empty(); }
  /// Is it the hub or the rigid body that carries the root of this body?
  bool carries(const std::string& name) const {
    return body == name && edge == "root" && !to.empty();
  }
  bool on_rigid_body() const { return holds_frame() && !b.on_ground(); }
  bool between_bodies() const { return !holds_frame() && (!a.on_ground() || !b.on_ground()); }
  /// Does it weld a plate or beam to another one?
  bool joins_edges() const { return !edge_a.empty(); }
  bool holds_edges() const { return !edges.empty(); }
  /// The material point at which it holds this plate or beam, where it does not hold an edge [m].
  std::optional<Vec2> point_on(const std::string& name) const {
    if (holds_frame() || holds_edges() || drives_line) return {};
    if (a.body == name) return a.point;
    if (b.body == name) return b.point;
    if (body == name) return point;
    return {};
  }
};

}  // namespace flexmorph::cases
