#pragma once

#include "fem/elements/ancf_beam.h"

namespace flexmorph::testing {

/// Returns a beam whose reference is curved, tapered and sheared, with elements of different
/// length.
inline fem::AncfBeam crooked_beam(double height) {
  const std::vector<double> x = {0, 0.2, 0.35, 0.6};
  std::vector<fem::BeamNode> nodes = fem::curve_reference(
      [](double s) {
        return fem::CentreLine{{s, 0.6 * s * s}, {1, 1.2 * s}, 1 - 0.8 * s};
      },
      x);
  for (fem::BeamNode& n : nodes) n.r_y += 0.2 * n.r_x;
  return {x, height, nodes};
}

}  // namespace flexmorph::testing
