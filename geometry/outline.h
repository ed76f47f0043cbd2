#pragma once

#include <span>
#include <vector>

#include "geometry/component.h"
#include "geometry/grid.h"

namespace flexmorph {

/// A polygon with holes: the outer ring is counterclockwise, holes are clockwise [m].
struct Region {
  std::vector<Vec2> outer;
  std::vector<std::vector<Vec2>> holes;
};

/// Exact union (CGAL, exact predicates and constructions) of polygons, clipped to the box of the
/// grid's domain. One Region per connected piece.
///
/// Polygons may be given in either sense of rotation. Vertices of the result are exact inside and
/// rounded to double on the way out. Pieces that share no more than a vertex stay apart.
/// @throws Error(numerical) when a polygon is not simple, has no area or is not finite;
///         Error(input) when the box is empty.
std::vector<Region> unite(std::span<const std::vector<Vec2>> polygons, const Box& clip);

double area(const Region& r);  ///< [m^2]
double area(std::span<const Region> r);

/// Is the point inside or on the boundary of the region?
bool contains(const Region& r, const Vec2& point);

/// Sharp picture of a design: area fraction of the true union in every cell.
///
/// Each cell is sampled at `samples` x `samples` midpoints. A sample in a `solid` box is material
/// whatever else is there; otherwise one in an `empty` box is void whatever the components do.
/// @throws Error(input) when samples < 1.
VectorXd area_fractions(const Grid& grid, std::span<const Component> components,
                        double min_half_thickness, std::span<const Box> solid,
                        std::span<const Box> empty, int samples = 8);

/// What hangs together in a sharp picture.
///
/// Cells with fraction >= 0.5 are material; those that share an edge (not only a corner) belong
/// to one piece. The main piece is the largest, by cells, of those that reach from the first to
/// the last column of cells, or the largest of all when none does.
struct Connectivity {
  bool connected = false;  ///< one piece reaches from the first to the last column of cells
  int islands = 0;         ///< pieces other than the main piece
};
Connectivity connectivity(const Grid& grid, const VectorXd& fractions);

}  // namespace flexmorph
