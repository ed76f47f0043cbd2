#pragma once

#include "geometry/base.h"

namespace flexmorph::fem {

/// Singular values of a square matrix, the largest first, and the left singular vectors as columns
/// (one-sided Jacobi rotations: small values keep their digits). In a file of its own, because
/// compiling it takes as long as ten others.
struct SingularValues {
  VectorXd values;
  MatrixXd left;
};
SingularValues singular_values(const MatrixXd& a);

}  // namespace flexmorph::fem
