#pragma once

#include <memory>
#include <span>
#include <vector>

#include "fem/dofs.h"
#include "fem/solve/turned_vectors.h"
#include "geometry/archive.h"

namespace flexmorph::fem {

/// Solver for matrices that are symmetric and positive definite except for a few of their unknowns,
///
///   [ A  Eᵀ ]   A (n x n) symmetric, positive definite, E (m x n), D (m x m) any, n >> m:
///   [ E  D  ]   Multifrontal factor A = L Lᵀ, dense LU factor of S = D - E A⁻¹ Eᵀ.
///
/// The border (the m unknowns of E and D) is found from the matrix. It contains constraint rows
/// (those without an entry on the diagonal), the unknowns they act on (and their neighbours where A
/// is not positive definite otherwise), and all unknowns i and j with a_ij ≠ a_ji, as where
/// material flows through the mesh near a joint. It grows when a matrix requires more unknowns in
/// it. The remaining unknowns are eliminated in an order of little fill, the border last.
class BorderedCholesky {
 public:
  BorderedCholesky();
  ~BorderedCholesky();

  /// Analyses the pattern of a matrix.
  /// @returns true if the pattern is symmetric and has few constraints; otherwise factorize() must
  ///     not be called.
  bool analyze(const SparseMatrix& a);
  /// Factors a matrix with the analysed pattern.
  /// @returns false, and nothing can be solved, when the border is too large, the remaining matrix
  ///     not positive definite, or S too close to singular.
  /// @param miss  allowed relative error of solutions. Where too many unknowns are unsymmetric for
  ///     a border, the symmetric part of A replaces A if the estimated error is not larger. After
  ///     one failure this is not tried again before the next analyze()
  bool factorize(const SparseMatrix& a, double miss = 0);
  /// Returns a flag for every unknown, 1 if it belongs to the border (n + m).
  const std::vector<char>& border() const;
  /// Updates the border. The factor L of the last successful factorize() is kept but rotated. Then
  /// the matrix that solve() solves is
  ///
  ///   [ Q A Qᵀ   Q Eᵀ Rᵀ ]   Q, R the rotations since then of the unknowns of A and of the border,
  ///   [ R E Qᵀ   D       ]   D from the given matrix.
  ///
  /// @returns false, and nothing can be solved, where only one entry of a vector belongs to the
  ///     border, or S is too close to singular.
  bool renew_border(const SparseMatrix& a, std::span<const TurnedVectors> turns);
  /// Computes x = a⁻¹ b (n + m), or a⁻ᵀ b.
  void solve(const VectorXd& b, VectorXd& x, bool transposed = false);

  /// Saves or restores the border as it has grown; call it after analyze().
  void archive(Archive& memory);

 private:
  double misses(const SparseMatrix& a);

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace flexmorph::fem
