#pragma once

#include <vector>

#include "fem/section.h"
#include "geometry/grid.h"

namespace flexmorph::mmc {

/// A plate that is designed: all but its design.
struct Plate {
  Grid grid;
  fem::PlaneSection section;
  std::vector<signed char> outside;  ///< cells that do not belong to the domain: 1; empty: none

  bool has(int cell) const { return outside.empty() || !outside[static_cast<size_t>(cell)]; }
  int n_domain_cells() const;
  double full_mass() const;  ///< ρ c A [kg]
};

}  // namespace flexmorph::mmc
