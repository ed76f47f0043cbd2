#pragma once

#include <cmath>
#include <numbers>
#include <random>

#include "geometry/grid.h"

namespace flexmorph::mmc {

/// Scale factors that are smooth functions of one parameter s.
struct SmoothDesign {
  VectorXd phase, speed;  ///< One entry per cell (n_cells).

  SmoothDesign(const Grid& g, unsigned seed) : phase(g.n_cells()), speed(g.n_cells()) {
    std::mt19937 engine(seed);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (int c = 0; c < g.n_cells(); ++c) {
      phase(c) = 2 * std::numbers::pi * uniform(engine);
      speed(c) = 0.5 + uniform(engine);
    }
  }
  // log10 of the stiffness varies between -3 and 0, the mass between 0.02 and 1.
  VectorXd stiffness(double s) const {
    return (1.5 * std::numbers::ln10 * ((phase + s * speed).array().sin() - 1)).exp();
  }
  VectorXd d_stiffness(double s) const {
    return stiffness(s).array() * 1.5 * std::numbers::ln10 * speed.array() *
           (phase + s * speed).array().cos();
  }
  VectorXd mass(double s) const { return 0.51 + 0.49 * (phase + s * speed).array().sin(); }
  VectorXd d_mass(double s) const {
    return 0.49 * speed.array() * (phase + s * speed).array().cos();
  }
};

}  // namespace flexmorph::mmc
