#pragma once

#include <any>
#include <optional>
#include <string>
#include <vector>

#include "cases/scene/drive.h"
#include "cases/scene/rigid_body.h"
#include "fem/joint.h"

/// The joints of a case: [[joint]]. A hub is a rigid frame with prescribed motion that carries a
/// body; a sleeve is a frame at rest through which material slides.
namespace flexmorph::cases {

struct JointRow;

/// An entry of [[joint]]. The meaning of its members depends on its row (joints/); a member that
/// the row does not read keeps its default.
struct Joint {
  const JointRow* row = nullptr;  ///< Kind of the joint.
  std::string body;               ///< Plate or beam of a joint that holds edges, lines or pins.
  std::string name;               ///< Name in messages and tables.
  bool named = false;             ///< True if the case names it; motion.csv then has its forces.
  Anchor a, b;            ///< Anchors of a joint between bodies; b also of an edge on a rigid body.
  std::vector<Law> laws;  ///< Prescribed coordinates, in the order of the row [m, rad].
  std::string edge;       ///< Edge in a hub, in a sleeve or on a rigid body; empty: none.
  std::string edge_a, edge_b;  ///< Edges at a and b of a weld between plates and beams.
  std::string to;              ///< Hub or rigid body that `edge` is welded to.
  fem::WeldMode mode = fem::WeldMode::edge;  ///< Components that a held edge keeps.
  Vec2 position{0, 0};                       ///< Position of a sleeve [m].
  double angle = 0;                          ///< Angle of a sleeve or of a welded edge [rad].
  Vec2 point{0, 0};                          ///< Material point of a pin [m].
  std::vector<int> components;               ///< Held or driven components of a position: 0, 1, 2.
  std::vector<std::string> edges;            ///< Edges of a plate in space that are held.
  int line = 0;              ///< Number of the m-line that is driven, or that `edge` names.
  bool drives_line = false;  ///< True if a free material line is driven.
  double speed = 0;          ///< Constant speed of a driven line through the material [m/s].
  Law at;                    ///< Drive of the material coordinate of a driven line, if any [m].
  std::any own;              ///< Data that only the functions of the row use.

  /// Returns true if an edge is held in a hub, in a sleeve or on a rigid body.
  bool holds_frame() const { return !edge.empty(); }
  /// Returns true if the joint welds the root of this body to a hub or a rigid body.
  bool carries(const std::string& name) const {
    return body == name && edge == "root" && !to.empty();
  }
  /// Returns true if an edge is held on a rigid body.
  bool on_rigid_body() const { return holds_frame() && !b.on_ground(); }
  /// Returns true if the joint acts between two anchors, of which one may be on the ground.
  bool between_bodies() const { return !holds_frame() && (!a.on_ground() || !b.on_ground()); }
  /// Returns true if the joint welds a plate or beam to another plate or beam.
  bool joins_edges() const { return !edge_a.empty(); }
  /// Returns true if edges of a plate in space are held where they are in the undeformed plate.
  bool holds_edges() const { return !edges.empty(); }
  /// Returns the material point at which the joint holds this plate or beam [m]; nothing if it
  /// holds no point of it.
  std::optional<Vec2> point_on(const std::string& name) const {
    if (holds_frame() || holds_edges() || drives_line) return {};
    if (a.body == name) return a.point;
    if (b.body == name) return b.point;
    if (body == name) return point;
    return {};
  }
};

}  // namespace flexmorph::cases
