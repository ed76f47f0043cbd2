#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "fem/dofs.h"
#include "fem/solve/turned_vectors.h"
#include "geometry/archive.h"

namespace flexmorph::fem {

/// Direct solver for the sparse square matrices of dynamics and statics,
///
///   [ A  Φ_qᵀ ]
///   [ Φ_q  0  ]    in any order: rows of Φ_q are those without an entry on the diagonal.
///
/// Matrices that are symmetric and positive definite except for a border (constraints, material
/// that flows near a joint) are factored by BorderedCholesky, all others by UMFPACK, which costs
/// three to five times as much. The pattern is analysed once; every factorization chooses the
/// method again.
class DirectSolver {
 public:
  DirectSolver();
  ~DirectSolver();
  /// Takes over the analysis and the factors of another solver.
  DirectSolver(DirectSolver&&) noexcept;
  /// Replaces the analysis and the factors by those of another solver.
  DirectSolver& operator=(DirectSolver&&) noexcept;

  /// Analyses the pattern of a compressed matrix; values may change afterwards.
  void analyze(const SparseMatrix& a);
  /// Factors a matrix with the analysed pattern.
  /// @throws Error (numerical) when the matrix is singular or not finite.
  /// @param miss  allowed relative error of solutions, for the tangents of an outer iteration; with
  ///     it a nearly symmetric matrix (material flow adds a contribution of order h |rate| /
  ///     length) is factored by Cholesky as well
  void factorize(const SparseMatrix& a, double miss = 0);
  /// Computes x = A⁻¹ b with the matrix of the last factorize(), which must still exist.
  /// @param refine  true for one step of iterative refinement; an outer iteration does not need it.
  void solve(const SparseMatrix& a, const VectorXd& b, VectorXd& x, bool refine = true) const;
  /// Computes x = A⁻ᵀ b with the factors of the last factorize().
  void solve_transposed(const SparseMatrix& a, const VectorXd& b, VectorXd& x,
                        bool refine = true) const;

  /// Returns a flag for every unknown, 1 if it belongs to the border of the last factor; an empty
  /// list if that factor has no border or the matrix is small.
  const std::vector<char>& border() const;
  /// Updates the border of the last factor. The factor of the remaining unknowns is kept but
  /// rotates with the vectors, and the entries between unknowns of the border are taken from the
  /// given matrix. Afterwards solutions are not refined.
  /// @param a  the new entries in the border, elsewhere the matrix of the last factorize()
  /// @param turns  rotations since the last factorize(); vectors that are not listed do not rotate
  /// @returns false where this is not solvable; the next call must then be factorize().
  bool renew_border(const SparseMatrix& a, std::vector<TurnedVectors> turns);
  /// Returns the matrix that solve() solves: the matrix of the last factorize(), or its
  /// modification by renew_border().
  SparseMatrix as_solved(const SparseMatrix& a) const;

  /// Saves or restores the matrix values from which analysis and factors were made. On restoring,
  /// both are recomputed, identical bit for bit.
  /// @param a  the matrix of the last factorize(), or of analyze() if no factorize() followed
  void archive(Archive& memory, const SparseMatrix& a);

  /// Returns true if the last factorization was made by BorderedCholesky.
  bool is_cholesky() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Returns the name of the kernels of OpenBLAS, which all direct solvers use: "Haswell",
/// "SkylakeX", ...; "unknown" for another BLAS. The environment variable OPENBLAS_CORETYPE selects
/// other kernels when the process starts.
std::string blas_kernel();

}  // namespace flexmorph::fem
