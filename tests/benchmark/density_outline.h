#pragma once

#include <vector>

#include "optim/mmc/problem/body_problem.h"
#include "tests/benchmark/density_method.h"

/// Conversion of densities to an outline that can be manufactured, as it would be given to another
/// program.
namespace flexmorph::benchmark {

/// Returns the mean of the domain's cells around each node (n_nodes); 0 if there are none.
VectorXd nodal_means(const mmc::Plate& plate, const VectorXd& cells);

/// Returns rings around the part of the domain where densities are above a level. A density is the
/// value at the centre of its cell, nodes have the mean of the cells around them, and the field is
/// linear on the quarters of each cell. Therefore thin members keep their densities, and the area
/// is continuous in the level. Outer rings are counterclockwise, holes clockwise; the border of the
/// domain is part of the rings.
/// @param cells  (n_cells)
std::vector<std::vector<Vec2>> contour(const mmc::Plate& plate, const VectorXd& cells,
                                       double level);

/// Returns the contour united with the given solid regions, minus the voids, clipped to the domain.
std::vector<Region> regions_above(const mmc::BodyProblem& problem, const VectorXd& cells,
                                  double level);

struct DensityOutline {
  std::vector<Region> regions;
  double level = 0;
};
/// Returns the regions above the level at which they enclose an area.
/// @param allowed  area [m²]; met within 1e-6 of it
/// @throws Error (numerical) if no level between 0 and 1 gives this area.
DensityOutline outline_of(const mmc::BodyProblem& problem, const VectorXd& cells, double allowed);

}  // namespace flexmorph::benchmark
