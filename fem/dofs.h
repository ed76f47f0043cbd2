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
};

}  // namespace flexmorph::fem
