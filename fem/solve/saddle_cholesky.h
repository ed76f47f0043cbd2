#pragma once

#include <memory>

#include "fem/dofs.h"

namespace flexmorph::fem {

/// Symmetric saddle point matrices [A Bᵀ; B 0] with A positive definite and few rows of B:
/// supernodal Cholesky factor of A (CHOLMOD, AMD order), Cholesky factor of the Schur complement B
/// A⁻¹ Bᵀ.
class SaddleCholesky {
 public:
  SaddleCholesky();
  ~SaddleCholesky();

  /// Rows without an entry on the diagonal are those of B.
  /// @returns whether the pattern is symmetric with few rows of B; if not, factorize() must not be
  ///          called.
  bool analyze(const SparseMatrix& a);
  /// @returns false, and nothing can be solved, when the matrix is not symmetric, A not positive
  ///          definite, or one of the two factors too near to singular to be trusted.
  bool factorize(const SparseMatrix& a);
  /// x = a⁻¹ b (n).
  void solve(const VectorXd& b, VectorXd& x);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace flexmorph::fem
