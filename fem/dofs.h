#pragma once

#include <Eigen/SparseCore>

#include "geometry/base.h"

namespace flexmorph::fem {

using SparseMatrix = Eigen::SparseMatrix<double>;

/// State of a model at one time.
struct State {
  double t = 0;      ///< [s]
  VectorXd q, v, a;  ///< unknowns, their rates and accelerations (n)
  VectorXd lambda;   ///< Lagrange multipliers (m)
  /// Angles that links follow over whole turns, as they were after the last accepted step [rad];
  /// empty before the first one.
  VectorXd turned;
};

}  // namespace flexmorph::fem
