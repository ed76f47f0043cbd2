#pragma once

#include <memory>

#include "fem/dofs.h"

namespace flexmorph::fem {

/// Direct solver for square matrices without symmetry (UMFPACK): material flow and constraints
/// make the matrices of dynamics unsymmetric and indefinite. The pattern is analysed once.
class UnsymmetricSolver {
 public:
  UnsymmetricSolver();
  ~UnsymmetricSolver();
  UnsymmetricSolver(UnsymmetricSolver&&) noexcept;
  UnsymmetricSolver& operator=(UnsymmetricSolver&&) noexcept;

  /// Analyses the pattern of a compressed matrix; values may change afterwards.
  void analyze(const SparseMatrix& a);
  /// @throws Error (numerical) when the matrix is singular or not finite.
  void factorize(const SparseMatrix& a);
  /// x = A⁻¹ b with the matrix of the last factorize(), which must still exist.
  /// @param refine  one step of iterative refinement; an outer iteration does not need it.
  void solve(const SparseMatrix& a, const VectorXd& b, VectorXd& x, bool refine = true) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace flexmorph::fem
