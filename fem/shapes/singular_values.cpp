#include "fem/shapes/singular_values.h"

#include <Eigen/SVD>

namespace flexmorph::fem {

SingularValues singular_values(const MatrixXd& a) {
  const Eigen::JacobiSVD<MatrixXd, Eigen::NoQRPreconditioner> svd(a, Eigen::ComputeFullU);
  return {svd.singularValues(), svd.matrixU()};
}

}  // namespace flexmorph::fem
