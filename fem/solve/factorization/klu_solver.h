#pragma once

#include <memory>

#include "fem/dofs.h"
#include "geometry/memory.h"

namespace flexmorph::fem {

/// Direct solver for small sparse square matrices that are factored again and again (KLU).
///
/// The pattern is analysed once. A factorization keeps the pivots of the one before and allocates
/// nothing, until they are no longer good enough: then it pivots anew.
class KluSolver {
 public:
  KluSolver();
  ~KluSolver();
  KluSolver(KluSolver&&) noexcept;
  KluSolver& operator=(KluSolver&&) noexcept;

  /// Analyses the pattern of a compressed matrix; values may change afterwards.
  /// @throws Error (numerical) when the pattern alone makes it singular.
  void analyze(const SparseMatrix& a);
  /// @throws Error (numerical) when the matrix is singular or not finite.
  void factorize(const SparseMatrix& a);
  /// b becomes A⁻¹ b, with the matrix of the last factorize().
  void solve(VectorXd& b) const;
  /// What analysis and factors came from: put back, they are made anew, the same bit for bit.
  /// @param a  the matrix of the last factorize(), or analyze() after it
  void remember(Memory& memory, const SparseMatrix& a);
  /// Estimate of ‖A‖₁ ‖A⁻¹‖₁ of the matrix of the last factorize().
  double condition(const SparseMatrix& a) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace flexmorph::fem
