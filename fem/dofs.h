#pragma once

#include <Eigen/SparseCore>

#include "geometry/base.h"

namespace flexmorph::fem {

/// Sparse matrix of doubles, stored by columns.
using SparseMatrix = Eigen::SparseMatrix<double>;

/// State of a model at one time: unknowns, their rates and the multipliers.
struct State {
  double t = 0;      ///< Time [s].
  VectorXd q, v, a;  ///< Unknowns, their rates and their accelerations (n_dofs).
  VectorXd lambda;   ///< Lagrange multipliers of the constraints (n_constraints).

  /// Angles that force elements count over whole turns, at the last accepted step [rad]; empty
  /// before the first step.
  VectorXd turned;
};

}  // namespace flexmorph::fem
