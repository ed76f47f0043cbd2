#pragma once

#include <span>
#include <string>
#include <vector>

#include "geometry/components/component.h"
#include "geometry/components/outline.h"
#include "geometry/grid.h"

/// Sharp pictures of a design: what its outlines enclose, cell by cell.
namespace flexmorph {

/// Sharp picture of a design: area fraction of the true union in every cell.
///
/// Each cell is sampled at `samples` x `samples` midpoints. A sample in a `solid` polygon is
/// material whatever else is there; otherwise one in an `empty` one is void whatever the components
/// do.
/// @throws Error(input) when samples < 1.
VectorXd area_fractions(const Grid& grid, std::span<const Component> components,
                        double min_half_thickness, std::span<const std::vector<Vec2>> solid,
                        std::span<const std::vector<Vec2>> empty, int samples = 8);

/// Area fractions of polygons in every cell, by the exact integral over their sides (n_cells).
/// Polygons do not overlap and lie in the domain of the grid.
VectorXd area_fractions(const Grid& grid, std::span<const Region> regions);

/// Samples columns of cells anew where components have changed: all others are as they were.
/// @param left, right  between which they have [m]
void update_area_fractions(const Grid& grid, std::span<const Component> components,
                           double min_half_thickness, std::span<const std::vector<Vec2>> solid,
                           std::span<const std::vector<Vec2>> empty, double left, double right,
                           VectorXd& fractions, int samples = 8);

/// Cells that a support holds or that a load acts on. A piece of material touches them when one of
/// the cells is material of the piece.
struct HeldOrLoaded {
  std::string name;         ///< for messages
  bool is_support = false;  ///< whether the cells are held; otherwise a load acts on them
  std::vector<int> cells;
};
/// The first column of cells as a support and the last one as a load.
std::vector<HeldOrLoaded> ends_of(const Grid& grid);

/// Which loads of a design have a way through its material to a support.
struct Connectivity {
  /// Whether every load touches a piece that touches a support; where no load has a place, as of
  /// weight alone, whether a piece touches a support.
  bool connected = false;
  int islands = 0;                           ///< number of pieces less one
  std::vector<std::string> loose_loads;      ///< loads without a way to a support
  std::vector<std::string> unused_supports;  ///< supports without a way to a load
};
/// Joins what pieces of material touch.
/// @param touched  for every piece which places it touches (n_pieces x n_places)
Connectivity connectivity_of(const std::vector<std::vector<bool>>& touched,
                             std::span<const HeldOrLoaded> places);
/// Connectivity of a sharp picture: cells with a fraction of at least 0.5 are material; those that
/// share an edge (not only a corner) belong to one piece.
/// @param places  empty: ends_of(grid)
Connectivity connectivity(const Grid& grid, const VectorXd& fractions,
                          std::span<const HeldOrLoaded> places = {});

/// Cells whose centre lies in a region or on its boundary, in ascending order.
std::vector<int> cells_within(const Grid& grid, const Region& region);
/// Cells whose centre lies outside of a domain, or in its holes: 1, the others 0 (n_cells).
std::vector<signed char> cells_outside(const Grid& grid, const Region& domain);

}  // namespace flexmorph
