#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "fem/dofs.h"
#include "fem/solve/turned_vectors.h"
#include "geometry/memory.h"

namespace flexmorph::fem {

/// Direct solver for the sparse square matrices of dynamics and statics,
///
///   [ A  Φ_qᵀ ]
///   [ Φ_q  0  ]    in any order: rows of Φ_q are those without an entry on the diagonal.
///
/// Those that are symmetric and positive definite but for a border (constraints, material that
/// flows near a joint) by BorderedCholesky, all others by UMFPACK, at three to five times the cost.
/// The pattern is analysed once; which of them it is shows at every factorization anew.
class UnsymmetricSolver {
 public:
  UnsymmetricSolver();
  ~UnsymmetricSolver();
  UnsymmetricSolver(UnsymmetricSolver&&) noexcept;
  UnsymmetricSolver& operator=(UnsymmetricSolver&&) noexcept;

  /// Analyses the pattern of a compressed matrix; values may change afterwards.
  void analyze(const SparseMatrix& a);
  /// @throws Error (numerical) when the matrix is singular or not finite.
  /// @param miss  for the tangents of an outer iteration: solutions may miss by this part of
  ///              themselves, so that a matrix that is nearly symmetric (material flow adds a part
  ///              of order h |rate| / length) is factored by Cholesky, too
  void factorize(const SparseMatrix& a, double miss = 0);
  /// x = A⁻¹ b with the matrix of the last factorize(), which must still exist.
  /// @param refine  one step of iterative refinement; an outer iteration does not need it.
  void solve(const SparseMatrix& a, const VectorXd& b, VectorXd& x, bool refine = true) const;
  /// x = A⁻ᵀ b with the same factors.
  void solve_transposed(const SparseMatrix& a, const VectorXd& b, VectorXd& x,
                        bool refine = true) const;

  /// Which unknowns belong to the border of the last factor; none where it has no border.
  const std::vector<char>& border() const;
  /// The factor of what does not belong to the border is kept but turns with the vectors, entries
  /// among the border are those of a now. From here on there is no refinement.
  /// @param a      elsewhere that of the last factorize()
  /// @param turns  since then; vectors that are not named stay
  /// @returns false, and the next call must be factorize(), where that cannot be solved.
  bool renew_border(const SparseMatrix& a, std::vector<TurnedVectors> turns);
  /// The matrix that solve() solves: that of the last factorize(), or renew_border().
  SparseMatrix as_solved(const SparseMatrix& a) const;

  /// What analysis and factors came from: put back, they are made anew, the same bit for bit.
  /// @param a  the matrix of the last factorize(), or analyze() after it
  void remember(Memory& memory, const SparseMatrix& a);

  /// Was the last factor that of Cholesky?
  bool is_cholesky() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Returns the kernels that OpenBLAS, under all direct solvers, computes with: "Haswell",
/// "SkylakeX", ...; "unknown" of another BLAS. The environment variable OPENBLAS_CORETYPE chooses
/// others, when the process starts.
std::string blas_kernel();

}  // namespace flexmorph::fem
