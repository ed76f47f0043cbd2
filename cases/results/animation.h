#pragma once

#include <string>
#include <vector>

#include "geometry/archive.h"

/// Frames of a motion, from which the report draws the moving mechanism. Bodies in space are
/// projected onto the plane of the pictures in space, see io::seen_from_above().
namespace flexmorph::cases {

/// A moving body. Positions are those of the time steps, without interpolation.
struct AnimatedBody {
  /// Kind of the body: a plate or beam with a grid of points, a rigid body, a hub, a point mass.
  enum class Kind { grid, rigid, hub, mass };

  std::string name;        ///< Name of the body in the case.
  Kind kind = Kind::grid;  ///< Kind of the body.

  /// Numbers of equal intervals of the grid along and across the body; 0 for other kinds.
  int along = 0, across = 0;
  double width = 0;    ///< Dimension across the axis [m]; of other kinds the drawn radius [m].
  double largest = 0;  ///< Material coordinate X of the free end [m].

  /// Points in the axes of the body (2 n) [m]: of a grid the undeformed points, empty if its length
  /// changes; of a rigid body the corners of its rectangle, empty if it has no size.
  std::vector<double> shape;
  std::vector<double> anchors;  ///< Points where joints and springs act on a rigid body (2 n) [m].
  /// Origin and angle of the rigid motion in every frame (3 n_frames) [m, m, rad].
  std::vector<double> poses;
  /// Material coordinate X of the root of a grid in every frame (n_frames) [m].
  std::vector<double> roots;
  /// Points of the grid in every frame, across first (2 (along + 1) (across + 1) n_frames) [m].
  std::vector<double> points;
  /// Points of the grid moved with the rigid motion alone, in every frame, of a body in space;
  /// empty in the plane, where they follow from `poses`.
  std::vector<double> rigid;

  /// Saves or restores the body.
  void archive(Archive& memory) {
    memory(name, kind, along, across, width, largest, shape, anchors, poses, roots, points, rigid);
  }
};

/// A place of the mechanism that is drawn with a symbol: a joint, or an observed point.
struct AnimatedMark {
  std::string name;     ///< Name in the case; empty if it has none.
  std::string type;     ///< Type of the joint; "observe" for an observed point.
  bool ground = false;  ///< True if the joint is fixed to the ground.
  bool driven = false;  ///< True if a drive prescribes a coordinate of the joint.

  /// Position and angle of the axis in every frame (3 n_frames) [m, m, rad].
  std::vector<double> at;

  /// Saves or restores the mark.
  void archive(Archive& memory) { memory(name, type, ground, driven, at); }
};

/// A spring, damper or end stop between two points.
struct AnimatedSpring {
  std::string name;  ///< Name in the case; empty if it has none.
  std::string type;  ///< Type of the spring.

  /// Positions of both ends in every frame (4 n_frames) [m].
  std::vector<double> ends;

  /// Saves or restores the spring.
  void archive(Archive& memory) { memory(name, type, ends); }
};

/// The frames of a motion, with equal spacing in time as far as the time steps allow, or of a path
/// of equilibria.
struct Animation {
  std::vector<double> time;  ///< Time of every frame [s]; of a path the number of the equilibrium.
  std::vector<double> factor;  ///< Load factor of every frame of a path [-]; empty for a motion.
  std::vector<AnimatedBody> bodies;     ///< Bodies in the order in which they are drawn.
  std::vector<AnimatedMark> marks;      ///< Joints and observed points.
  std::vector<AnimatedSpring> springs;  ///< Springs, dampers and end stops.

  /// Saves or restores the frames.
  void archive(Archive& memory) { memory(time, factor, bodies, marks, springs); }
};

}  // namespace flexmorph::cases
