#pragma once

#include <Eigen/SparseCore>

#include "geometry/base.h"

/// Dense linear algebra of Eigen that tests compare with, compiled once: its decompositions took up
/// to half of the compile time of files that used them.
namespace flexmorph::testing {

/// Solution x of A x = b by LU factors with partial pivoting, for one column b or several.
MatrixXd solve(const MatrixXd& A, const MatrixXd& b);
/// Solution x of A x = b of a sparse positive definite A by its LDLᵀ factors.
MatrixXd solve(const Eigen::SparseMatrix<double>& A, const MatrixXd& b);
/// A⁻¹ of a square matrix.
MatrixXd inverse(const MatrixXd& A);
/// Number of pivots of LU factors with full pivoting above `threshold` times the largest.
int rank(const MatrixXd& A, double threshold);
/// Singular values of A, largest first.
VectorXd singular_values(const MatrixXd& A);
/// Eigenvalues of a symmetric matrix in ascending order; only its lower triangle is read.
VectorXd eigenvalues(const MatrixXd& A);

/// Eigenvalues ω² in ascending order and eigenvectors φ (columns, φᵀ M φ = 1) of K φ = ω² M φ.
struct Modes {
  VectorXd values;
  MatrixXd vectors;
};
/// Modes of symmetric matrices K and M, M positive definite.
Modes modes(const MatrixXd& K, const MatrixXd& M);

}  // namespace flexmorph::testing
