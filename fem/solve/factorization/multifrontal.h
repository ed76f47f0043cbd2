#pragma once

#include <span>
#include <vector>

#include "fem/solve/factorization/supernodes.h"
#include "geometry/base.h"

namespace flexmorph::fem {

/// Cholesky factor of the leading n unknowns of a symmetric matrix in its given order, and the
/// Schur complement of the m remaining unknowns, its border:
///
///   [ K  Eᵀ ]   [ L  0 ] [ Lᵀ Xᵀ ]
///   [ E  C  ] = [ X  1 ] [ 0  S  ],   S = C - X Xᵀ
///
/// Multifrontal method (Duff and Reid 1983): every block of columns passes one dense update to its
/// parent in the elimination tree, three products of dense matrices per block, however many blocks
/// follow. Rows of X are stored in the blocks like all other rows; updates without a parent add up
/// to -X Xᵀ.
///
/// Source: Duff, Reid (1983), ACM Trans. Math. Softw. 9, 302-325.
class Multifrontal {
 public:
  /// Analyses a pattern.
  /// @param starts, rows  lower triangle of the n columns (n + 1 starts), rows ascending, diagonal
  ///     first; rows from n on belong to E
  Multifrontal(std::vector<int> starts, std::vector<int> rows);

  /// Returns the number n of the unknowns of K.
  int size() const { return static_cast<int>(starts_.size()) - 1; }
  /// Returns the blocks of the factor.
  const Supernodes& blocks() const { return blocks_; }
  /// Returns the entries of K and E in the order of the pattern; write them, then call factorize().
  std::span<double> values() { return values_; }
  /// Returns the columns of L and X (height x width) of a block, its triangle first.
  const double* block(int s) const {
    return factor_.data() + blocks_.offset[static_cast<std::size_t>(s)];
  }

  /// Factors K with its present values.
  /// @param border  (m x m): its lower triangle becomes -X Xᵀ; null is allowed where m = 0
  /// @returns the column at which K is found not to be positive definite or not finite, or -1.
  int factorize(MatrixXd* border = nullptr);

  /// Returns condition_estimate() of K with its present values.
  double condition() const;

 private:
  void fill_block(int s, double* block);
  void add_update(int child, const double* update, int parent, double* block, double* own) const;
  int factorize_block(int s, double* block, bool keep, double* own) const;
  int smallest_pivot(int s) const;
  void add_to_border(int s, const double* update, MatrixXd& border) const;

  std::vector<int> starts_;
  std::vector<double> values_;
  Supernodes blocks_;
  std::vector<double> factor_;  // block by block
  std::vector<double> stack_;   // updates that have not been added to their parent yet
  std::vector<int> waiting_;    // blocks whose updates are on the stack
};

}  // namespace flexmorph::fem
