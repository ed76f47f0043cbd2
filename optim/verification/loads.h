#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fem/esl_set.h"
#include "geometry/parts/part_mesh.h"

/// Loads and supports of a part by position: nothing of them knows of cells or meshes.
namespace flexmorph::verification {

/// Where a part is held or pulled: the material on lines. Where there is none on any of them, the
/// material in the area, when there is one.
struct Location {
  std::vector<Segment> lines = {};
  std::vector<Vec2> area = {};  ///< corners of a polygon; empty: none [m]
};

/// What a point stands for: the border of the domain as far as `reach` to each side of it, in x and
/// in y; the material in that square where the point is not on the border, or no material is there.
/// (A point has no limit in two dimensions: its displacement under a force grows with every finer
/// mesh.)
/// @param border  of the domain, with its holes   @param reach  [m]
Location point_location(const Vec2& point, const Region& border, double reach);
/// A box, or a line where it has no width: as it is.
Location box_location(const Box& box);
/// The border of a polygon: the rim of a bore.
Location border_location(const std::vector<Vec2>& ring);

struct Support {
  int location = 0;  ///< of Loads
  bool x = false, y = false;
};
struct Force {
  int location = 0;
  Vec2 force{0, 0};      ///< in all, spread over the material there [N]
  double moment = 0;     ///< see ForceSpread [N m]
  bool bearing = false;  ///< of a pin in a bore, otherwise even
  Vec2 center{0, 0};     ///< of the bore [m]
};

/// What acts at the same time.
struct Load {
  std::string name = {};
  double weight = 1;
  std::vector<Force> forces = {};
  /// x of the line on which, and behind which, the part is held; nothing: supports alone hold it.
  std::optional<double> clamp = {};
  /// Acceleration minus gravity at the nodes of Loads::grid (2 n_nodes), bilinear between them: the
  /// body force -ρ a of all material [m/s²]. Null: none. Lives longer.
  const VectorXd* acceleration = nullptr;
  /// The clamp prescribes u = -g (0, y), see fem::EslSet::held_stretch; the compliance is uᵀ K u.
  double held_stretch = 0;
  /// The same across Loads::held_edge, see fem::EslSet::held_end_stretch.
  double held_end_stretch = 0;
};

/// What keeps the material on a line x = const straight and as wide as it is, wherever it goes:
/// springs between neighbours in y, whatever is between them, as of RestrainedExpansion.
struct HeldEdge {
  double x = 0;          ///< [m]
  double stiffness = 0;  ///< times the distance of two neighbours: k Δy [N]
};

/// Where a joint holds a link.
struct Pin {
  int location = 0;      ///< of Loads
  Vec2 center{0, 0};     ///< [m]
  bool bearing = false;  ///< Does it press on the rim of a bore?
};
/// What balances the loads of a link, see PartBalance.
struct Balance {
  bool floating = false;  ///< its own inertia; otherwise reactions at the pins
  std::array<Pin, 2> pins{};
};

struct Loads {
  std::vector<Location> locations;
  std::vector<Support> supports;
  std::vector<Load> loads;
  /// What Load::acceleration of loads points to where they all have the same uniform one.
  std::shared_ptr<const VectorXd> uniform_acceleration = {};
  std::optional<HeldEdge> held_edge = {};  ///< in front of all clamps; of all loads
  std::optional<Balance> balance = {};     ///< of a part without supports and clamps
  Grid grid;                               ///< of accelerations
  bool worst = false;  ///< What counts is the largest compliance, not the weighted sum.

  int add(Location location);  ///< @return its number
};

}  // namespace flexmorph::verification
