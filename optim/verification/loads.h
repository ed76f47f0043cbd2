#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fem/esl_set.h"
#include "geometry/parts/part_mesh.h"

/// Loads and supports of a part by their positions, independent of cells and meshes.
namespace flexmorph::verification {

/// A set of points of a part that is held or loaded: the material on lines. If there is no material
/// on any of the lines, it is the material in the area, if the location has an area.
struct Location {
  std::vector<Segment> lines = {};  ///< Lines of the location.
  std::vector<Vec2> area = {};      ///< Corners of a polygon [m]; empty: no area.
};

/// Returns the location that stands for a point, because a point has no limit in two dimensions:
/// its displacement under a force grows with every mesh refinement. The location is the border of
/// the domain within a square around the point, or, if the point is not on the border or no
/// material is there, the material in that square.
/// @param border  border of the domain with its holes
/// @param reach   half the side of the square [m]
Location point_location(const Vec2& point, const Region& border, double reach);
/// Returns the location of a box: its area, or a line if the box has no width.
Location box_location(const Box& box);
/// Returns the border of a polygon as a location, for example the rim of a bore.
Location border_location(const std::vector<Vec2>& ring);

/// A location that is held in some directions.
struct Support {
  int location = 0;           ///< Index in Loads::locations.
  bool x = false, y = false;  ///< True if the displacement in this direction is held.
};

/// A force and a moment that act on a location.
struct Force {
  int location = 0;      ///< Index in Loads::locations.
  Vec2 force{0, 0};      ///< Resultant force, distributed over the material of the location [N].
  double moment = 0;     ///< Additional moment, see ForceSpread [N m].
  bool bearing = false;  ///< True if a pin in a bore exerts the force; otherwise it is uniform.
  Vec2 center{0, 0};     ///< Centre of the bore [m].
};

/// One load case: all loads that act at the same time.
struct Load {
  std::string name = {};           ///< Name of the load for messages and results.
  double weight = 1;               ///< Weight of the load in the sum of compliances [-].
  std::vector<Force> forces = {};  ///< Concentrated forces.

  /// Position x of the clamp [m]: the part is held on this line and behind it (at smaller x).
  /// Empty: only Loads::supports hold the part.
  std::optional<double> clamp = {};
  /// Acceleration minus gravity at the nodes of Loads::grid (2 n_nodes) [m/s²], bilinear between
  /// the nodes. It causes the body force -ρ a of all material. Null: no acceleration. The vector
  /// must outlive the load.
  const VectorXd* acceleration = nullptr;
  /// Thermal stretch g that the clamp suppresses [-], see fem::EslSet::held_stretch. The clamp
  /// prescribes u = -g (0, y), and the compliance is uᵀ K u.
  double held_stretch = 0;
  /// Thermal stretch that Loads::held_edge suppresses [-], see fem::EslSet::held_end_stretch.
  double held_end_stretch = 0;
};

/// A line x = const whose material stays straight and keeps its width, but may move as a whole.
/// Springs between neighbouring nodes in y hold it, whatever material is between them, as in
/// RestrainedExpansion.
struct HeldEdge {
  double x = 0;          ///< Position of the line [m].
  double stiffness = 0;  ///< Spring stiffness times the distance of its two nodes: k Δy [N].
};

/// A pin of a link (a body between two pins): the joint at which another body holds the link.
struct Pin {
  int location = 0;      ///< Index in Loads::locations.
  Vec2 center{0, 0};     ///< Centre of the pin [m].
  bool bearing = false;  ///< True if the pin presses on the rim of a bore.
};

/// Forces that balance the loads of a link, see PartBalance.
struct Balance {
  bool floating = false;      ///< True for inertia forces of the link; false for reactions at pins.
  std::array<Pin, 2> pins{};  ///< Both pins of the link.
};

/// All loads and supports of a part.
struct Loads {
  std::vector<Location> locations;  ///< Locations that supports, forces and pins refer to.
  std::vector<Support> supports;    ///< Supports that act in all loads.
  std::vector<Load> loads;          ///< Load cases.

  /// Acceleration that Load::acceleration of all loads points to if they have one uniform
  /// acceleration in common; null otherwise.
  std::shared_ptr<const VectorXd> uniform_acceleration = {};
  std::optional<HeldEdge> held_edge = {};  ///< Edge in front of all clamps that all loads hold.
  std::optional<Balance> balance = {};     ///< Balance of a part without supports and clamps.
  Grid grid;                               ///< Grid of the accelerations.
  bool worst = false;  ///< True if the largest compliance counts; false for the weighted sum.

  /// Adds a location and returns its index.
  int add(Location location);
};

}  // namespace flexmorph::verification
