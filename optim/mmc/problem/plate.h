#pragma once

#include <vector>

#include "fem/section.h"
#include "geometry/grid.h"

namespace flexmorph::mmc {

/// A plate that is to be designed: its design mesh, its material and its domain.
struct Plate {
  Grid grid;                  ///< Grid of the design cells.
  fem::PlaneSection section;  ///< Thickness and material.

  /// 1 for cells that do not belong to the domain (n_cells); empty if all belong to it.
  std::vector<signed char> outside;

  /// Returns true if a cell belongs to the domain.
  bool has(int cell) const { return outside.empty() || !outside[static_cast<size_t>(cell)]; }
  /// Returns the number of cells that belong to the domain.
  int n_domain_cells() const;
  /// Returns the mass ρ c A of the full domain [kg].
  double full_mass() const;
};

}  // namespace flexmorph::mmc
