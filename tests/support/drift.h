#pragma once

#include <algorithm>

#include "fem/model/workspace.h"

namespace flexmorph::testing {

/// Largest residuals of the constraints: Φ [m], Φ_q q̇ + Φ_t [m/s], Φ_q q̈ - γ [m/s²].
struct Drift {
  double position = 0, velocity = 0, acceleration = 0;

  void see(fem::Workspace& model, const fem::State& x) {
    fem::Constraints c;
    model.constraints(x, c);
    VectorXd rate = c.rate, second = -c.acceleration;
    for (const auto& entry : c.jacobian) {
      rate[entry.row()] += entry.value() * x.v[entry.col()];
      second[entry.row()] += entry.value() * x.a[entry.col()];
    }
    position = std::max(position, c.value.lpNorm<Eigen::Infinity>());
    velocity = std::max(velocity, rate.lpNorm<Eigen::Infinity>());
    acceleration = std::max(acceleration, second.lpNorm<Eigen::Infinity>());
  }
};

}  // namespace flexmorph::testing
