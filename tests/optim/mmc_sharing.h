#pragma once

#include "optim/mmc/loads/compliance_evaluator.h"
#include "tests/optim/mmc_small.h"

/// Bodies that share mass, for tests.
namespace flexmorph::mmc::test {

/// Returns the small plate, clamped at its left edge, with a force at its tip.
inline ComplianceEvaluator tip_load(const fem::PlaneSection& section, double force,
                                    double weight = 1) {
  std::vector<fem::HeldUnknown> held;
  for (int j = 0; j <= kGrid.ny; ++j)
    for (int c = 0; c < 2; ++c) held.push_back({kGrid.node(0, j), c});
  const int tip = kGrid.node(kGrid.nx, kGrid.ny / 2);
  return {{kGrid, section, {}},
          held,
          std::vector<LoadCase>{{"tip", weight, {{tip, {0, force}}}}},
          false};
}

/// A section that is thicker and lighter than that of the small plate.
inline const fem::PlaneSection kSecondSection{0.02, 1e8, 0.3, 900};
inline const Plate kOtherPlate{kGrid, kSecondSection, {}};

}  // namespace flexmorph::mmc::test
