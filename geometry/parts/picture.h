#pragma once

#include <span>
#include <string>
#include <vector>

#include "geometry/components/component.h"
#include "geometry/components/outline.h"
#include "geometry/grid.h"

/// Crisp pictures (0-1 geometry) of a design: the area inside its outlines, cell by cell.
namespace flexmorph {

/// Returns the area fraction of the exact union of components in every cell (n_cells).
///
/// Each cell is sampled at `samples` x `samples` midpoints. A sample in a `solid` polygon is
/// material in any case. Otherwise a sample in an `empty` polygon is void, even inside a component.
/// @throws Error (input) when samples < 1.
VectorXd area_fractions(const Grid& grid, std::span<const Component> components,
                        double min_half_thickness, std::span<const std::vector<Vec2>> solid,
                        std::span<const std::vector<Vec2>> empty, int samples = 8);

/// Returns the area fractions of polygons in every cell by the exact integral over their sides
/// (n_cells). The polygons must not overlap and must lie in the domain of the grid.
VectorXd area_fractions(const Grid& grid, std::span<const Region> regions);

/// Updates the area fractions in the columns of cells where components have changed. All other
/// columns are not modified.
/// @param left, right  ends of the interval of x in which components have changed [m]
/// @throws Error (input) when samples < 1.
void update_area_fractions(const Grid& grid, std::span<const Component> components,
                           double min_half_thickness, std::span<const std::vector<Vec2>> solid,
                           std::span<const std::vector<Vec2>> empty, double left, double right,
                           VectorXd& fractions, int samples = 8);

/// Cells that a support holds or on which a load acts. A connected region of material touches the
/// support or load if it contains one of the cells.
struct HeldOrLoaded {
  std::string name;         ///< Name for messages.
  bool is_support = false;  ///< True if a support holds the cells, false if a load acts on them.
  std::vector<int> cells;   ///< Indices of the cells.
};
/// Returns the first column of cells as a support and the last one as a load.
std::vector<HeldOrLoaded> ends_of(const Grid& grid);

/// The connectivity of a design: which loads have a path through the material to a support.
struct Connectivity {
  /// True if every load touches a connected region that touches a support. If no load acts on
  /// cells, as with weight alone, true if a connected region touches a support.
  bool connected = false;
  int islands = 0;                           ///< Number of connected regions minus one.
  std::vector<std::string> loose_loads;      ///< Names of loads without a path to a support.
  std::vector<std::string> unused_supports;  ///< Names of supports without a path to a load.
};
/// Returns the connectivity from the supports and loads that connected regions of material touch.
/// @param touched  true where a region touches a support or load (n_regions x n_locations)
/// @param locations   supports and loads (n_locations)
Connectivity connectivity_of(const std::vector<std::vector<bool>>& touched,
                             std::span<const HeldOrLoaded> locations);
/// Returns the connectivity of a crisp picture. Cells with a fraction of at least 0.5 are material;
/// cells that share an edge (not only a corner) belong to one connected region.
/// @param locations  supports and loads; empty means ends_of(grid)
Connectivity connectivity(const Grid& grid, const VectorXd& fractions,
                          std::span<const HeldOrLoaded> locations = {});

/// Returns the cells whose center lies in a region or on its boundary, in ascending order.
std::vector<int> cells_within(const Grid& grid, const Region& region);
/// Returns 1 for cells whose center lies outside a domain or in its holes, 0 for all others
/// (n_cells).
std::vector<signed char> cells_outside(const Grid& grid, const Region& domain);

}  // namespace flexmorph
