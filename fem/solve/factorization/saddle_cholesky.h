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
  /// Where A is not symmetric, its symmetric part stands for it if solutions then miss by no more
  /// than a part `miss` of themselves: an estimate of the spectral radius of 1 - a_s⁻¹ a, by two
  /// steps of the power method. Refused once, it is not tried again before the next analyze().
  /// @returns false, and nothing can be solved, when B and Bᵀ differ, A is not symmetric enough or
  ///          its symmetric part not positive definite, or one of the two factors is too near to
  ///          singular to be trusted.
  bool factorize(const SparseMatrix& a, double miss = 0);
  /// x = a⁻¹ b (n), or that of the symmetric part.
  void solve(const VectorXd& b, VectorXd& x);

  /// Was the symmetric part refused since the last analyze()?
  bool is_refused() const;
  void set_refused(bool refused);

 private:
  bool factorize_symmetric_part(const SparseMatrix& a);
  double misses(const SparseMatrix& a);

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace flexmorph::fem
