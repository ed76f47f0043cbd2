#include "tests/support/dense.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <Eigen/SparseCholesky>

namespace flexmorph::testing {

MatrixXd solve(const MatrixXd& A, const MatrixXd& b) { return A.partialPivLu().solve(b); }

MatrixXd solve(const Eigen::SparseMatrix<double>& A, const MatrixXd& b) {
  return Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(A).solve(b);
}

MatrixXd inverse(const MatrixXd& A) { return A.inverse(); }

int rank(const MatrixXd& A, double threshold) {
  Eigen::FullPivLU<MatrixXd> factors(A);
  return static_cast<int>(factors.setThreshold(threshold).rank());
}

VectorXd singular_values(const MatrixXd& A) { return A.jacobiSvd().singularValues(); }

VectorXd eigenvalues(const MatrixXd& A) {
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(A, Eigen::EigenvaluesOnly).eigenvalues();
}

Modes modes(const MatrixXd& K, const MatrixXd& M) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> solver(K, M);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace flexmorph::testing
