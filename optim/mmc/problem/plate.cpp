#include "optim/mmc/problem/plate.h"

#include <algorithm>

namespace flexmorph::mmc {

int Plate::n_domain_cells() const {
  return grid.n_cells() - static_cast<int>(std::count(outside.begin(), outside.end(), 1));
}

double Plate::full_mass() const {
  const double area = grid.dx() * grid.dy() * n_domain_cells();
  return section.density * section.thickness * area;
}

}  // namespace flexmorph::mmc
