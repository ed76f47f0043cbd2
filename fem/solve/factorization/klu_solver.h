#pragma once

#include <memory>

#include "fem/dofs.h"
#include "geometry/archive.h"

namespace flexmorph::fem {

/// Direct solver for small sparse square matrices that are factored repeatedly (KLU).
///
/// The pattern is analysed once. A factorization reuses the pivots of the previous one and
/// allocates no memory as long as they are good enough; otherwise it selects new pivots.
class KluSolver {
 public:
  KluSolver();
  ~KluSolver();
  /// Takes over the analysis and the factors of another solver.
  KluSolver(KluSolver&&) noexcept;
  /// Replaces the analysis and the factors by those of another solver.
  KluSolver& operator=(KluSolver&&) noexcept;

  /// Analyses the pattern of a compressed matrix; values may change afterwards.
  /// @throws Error (numerical) when the matrix is singular by its pattern.
  void analyze(const SparseMatrix& a);
  /// Factors a matrix with the analysed pattern.
  /// @throws Error (numerical) when the matrix is singular or not finite.
  void factorize(const SparseMatrix& a);
  /// Replaces b by A⁻¹ b, with the matrix of the last factorize().
  void solve(VectorXd& b) const;
  /// Saves or restores the matrix values from which analysis and factors were made. On restoring,
  /// both are recomputed, identical bit for bit.
  /// @param a  the matrix of the last factorize(), or of analyze() if no factorize() followed
  void archive(Archive& memory, const SparseMatrix& a);
  /// Returns an estimate of ‖A‖₁ ‖A⁻¹‖₁ of the matrix of the last factorize().
  double condition(const SparseMatrix& a) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace flexmorph::fem
