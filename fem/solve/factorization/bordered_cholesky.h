#pragma once

#include <memory>
#include <span>
#include <vector>

#include "fem/dofs.h"
#include "fem/solve/turned_vectors.h"
#include "geometry/memory.h"

namespace flexmorph::fem {

/// Matrices that are symmetric and positive definite but for a few of their unknowns,
///
///   [ A  Eᵀ ]   A (n x n) symmetric, positive definite, E (m x n), D (m x m) any, n >> m:
///   [ E  D  ]   Multifrontal factor A = L Lᵀ, dense LU factor of S = D - E A⁻¹ Eᵀ.
///
/// The border is found from the matrix: constraint rows (those without an entry on the diagonal),
/// the unknowns they act on (and their neighbours where A is not held without), and all unknowns i
/// and j with a_ij ≠ a_ji, as where material flows through the mesh near a joint. It grows when a
/// matrix asks for more, and the order of the others, of little fill, ends beside it.
class BorderedCholesky {
 public:
  BorderedCholesky();
  ~BorderedCholesky();

  /// @returns whether the pattern is symmetric and of few constraints; if not, factorize()
  ///          must not be called.
  bool analyze(const SparseMatrix& a);
  /// @returns false, and nothing can be solved, when the border is too large, the rest not positive
  ///          definite, or S too near to singular to be trusted.
  /// @param miss  where too many unknowns are not symmetric for a border, the symmetric part of A
  ///              stands for A if solutions then miss by no more than this part of themselves (an
  ///              estimate). Refused once, it is not tried again before the next analyze()
  bool factorize(const SparseMatrix& a, double miss = 0);
  /// Which unknowns belong to the border (n + m).
  const std::vector<char>& border() const;
  /// L stays that of the last factorize(), which succeeded, but turns: from here on solved is
  ///
  ///   [ Q A Qᵀ   Q Eᵀ Rᵀ ]   Q, R the turns of the unknowns of A and of the border since then,
  ///   [ R E Qᵀ   D       ]   D that of a as it is now.
  ///
  /// @returns false, and nothing can be solved, where the border parts the entries of a vector, or
  ///          S is too near to singular.
  bool renew_border(const SparseMatrix& a, std::span<const TurnedVectors> turns);
  /// x = a⁻¹ b (n + m), or a⁻ᵀ b.
  void solve(const VectorXd& b, VectorXd& x, bool transposed = false);

  /// The border as it has grown; after analyze().
  void remember(Memory& memory);

 private:
  double misses(const SparseMatrix& a);

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace flexmorph::fem
