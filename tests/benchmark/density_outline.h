#pragma once

#include <vector>

#include "optim/mmc/problem/body_problem.h"
#include "tests/benchmark/density_method.h"

/// From densities to an outline that can be made: what another program would be handed.
namespace flexmorph::benchmark {

/// Mean of the cells of the domain around each node (n_nodes); 0 where there are none.
VectorXd nodal_means(const mmc::Plate& plate, const VectorXd& cells);

/// Rings around the part of the domain where densities of cells are above a level. A density stands
/// at the centre of its cell, the mean of those around at a node, and between it is linear on the
/// quarters of each cell: thin members keep their densities, and the area is continuous in the
/// level. Outer rings are counterclockwise, holes clockwise; the border of the domain is part of
/// them.
/// @param cells  (n_cells)
std::vector<std::vector<Vec2>> contour(const mmc::Plate& plate, const VectorXd& cells,
                                       double level);

/// The contour with the given solid regions, less the voids, clipped to the domain.
std::vector<Region> regions_above(const mmc::BodyProblem& problem, const VectorXd& cells,
                                  double level);

struct DensityOutline {
  std::vector<Region> regions;
  double level = 0;
};
/// The regions above the level at which they enclose an area.
/// @param allowed  [m²]; met to 1e-6 of it
/// @throws Error (numerical) when no level between 0 and 1 does.
DensityOutline outline_of(const mmc::BodyProblem& problem, const VectorXd& cells, double allowed);

}  // namespace flexmorph::benchmark
