#pragma once

#include "geometry/base.h"

namespace flexmorph::fem {

/// Singular values and left singular vectors of a square matrix.
struct SingularValues {
  VectorXd values;  ///< Singular values, the largest first.
  MatrixXd left;    ///< Left singular vectors as columns.
};
/// Computes the decomposition by Jacobi rotations, which keep the relative accuracy of small
/// values. The function has its own source file, because its compilation takes as long as that of
/// ten others.
SingularValues singular_values(const MatrixXd& a);

}  // namespace flexmorph::fem
