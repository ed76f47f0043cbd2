#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "optim/mmc/fixed_loads.h"
#include "tests/optim/mmc_small.h"

/// Hot plates for tests.
namespace flexmorph::mmc::test {

/// Between `smallest` and 1, evenly in their logarithm.
inline VectorXd random_factors(const Grid& g, double smallest, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(std::log(smallest), 0);
  VectorXd factor(g.n_cells());
  for (double& f : factor) f = std::exp(uniform(engine));
  return factor;
}

/// turning_plate() hot, each load by another stretch of up to `a`, and slowed down until held
/// growth costs about what its loads do; the edge in the hub takes part in none of the growth, or
/// all.
inline fem::EslSets hot_plate(int n, double a, bool edge_grows = false) {
  fem::EslSets loads = turning_plate(n);
  for (int l = 0; l < n; ++l) {
    fem::EslSet& set = loads.sets[static_cast<size_t>(l)];
    set.acceleration *= 0.025;
    for (fem::NodalForce& f : set.forces) f.force *= 0.025;
    set.thermal_stretch = l == 1 ? -0.3 * a : a / (1 + 0.2 * l);
    set.held_stretch = edge_grows ? 0 : set.thermal_stretch;
  }
  return loads;
}

/// Steel at 300 K more than in the cold.
inline constexpr double kStretch = 4e-3;

/// Components of all nodes of column i.
inline std::vector<fem::HeldUnknown> edge(int i, std::vector<int> components) {
  std::vector<fem::HeldUnknown> held;
  for (int j = 0; j <= kGrid.ny; ++j)
    for (const int c : components) held.push_back({kGrid.node(i, j), c});
  return held;
}

inline std::vector<fem::HeldUnknown> operator+(std::vector<fem::HeldUnknown> a,
                                               const std::vector<fem::HeldUnknown>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

}  // namespace flexmorph::mmc::test
