#pragma once

#include <span>
#include <vector>

#include "geometry/component.h"
#include "geometry/grid.h"
#include "geometry/outline.h"

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

/// Samples columns of cells anew where components have changed: all others are as they were.
/// @param left, right  between which they have [m]
void update_area_fractions(const Grid& grid, std::span<const Component> components,
                           double min_half_thickness, std::span<const std::vector<Vec2>> solid,
                           std::span<const std::vector<Vec2>> empty, double left, double right,
                           VectorXd& fractions, int samples = 8);

/// What hangs together in a sharp picture.
///
/// Cells with fraction >= 0.5 are material; those that share an edge (not only a corner) belong
/// to one piece. The main piece is the largest, by cells, of those that reach from the first to
/// the last column of cells, or the largest of all when none does. Where places are named instead
/// (loaded and held ones), the main piece is the one that touches most of them.
struct Connectivity {
  bool connected = false;  ///< one piece touches both end columns, or every named place
  int islands = 0;         ///< pieces other than the main piece
};
/// @param places  cells of each place (touched when one of them is material); none: the ends
Connectivity connectivity(const Grid& grid, const VectorXd& fractions,
                          std::span<const std::vector<int>> places = {});

/// Cells whose centre lies in a region or on its boundary, in ascending order.
std::vector<int> cells_within(const Grid& grid, const Region& region);
/// Cells whose centre lies outside of a domain, or in its holes: 1, the others 0 (n_cells).
std::vector<signed char> cells_outside(const Grid& grid, const Region& domain);

}  // namespace flexmorph
