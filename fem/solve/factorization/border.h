#pragma once

#include <vector>

#include "fem/dofs.h"

namespace flexmorph::fem {

/// The border of a sparse matrix whose other unknowns have a symmetric part A of the matrix: the
/// constraints (unknowns without an entry on the diagonal), the unknowns that the constraints act
/// on, and all unknowns with unsymmetric entries. It grows when a matrix has further ones.
class Border {
 public:
  /// Finds the transposed entry of every entry, and the border around the constraints.
  /// @returns false if the pattern is unsymmetric or the border too large.
  bool analyze(const SparseMatrix& a);
  /// Widens the border by a second layer of unknowns around the constraints.
  /// @returns false, and nothing has changed, if the border has this layer or would be too large.
  bool add_second_layer(const SparseMatrix& a);
  /// Adds the unknowns with unsymmetric entries to the border.
  /// @returns true if there were any.
  bool widen(const SparseMatrix& a);
  /// Returns true if the border is small in comparison with the other unknowns.
  bool is_small_enough() const;

  std::vector<char> contains;    ///< True for the unknowns that belong to the border (n).
  std::vector<int> constraints;  ///< Unknowns without an entry on the diagonal.
  std::vector<int> mirrors;      ///< Index of the transposed entry of every entry.
  int layers = 1;                ///< Layers of unknowns around the constraints, 1 or 2.

 private:
  struct Pair {
    int row, column, lower, upper;  // indices of the entries (row, column) and (column, row)
  };
  bool pair_up(const SparseMatrix& a);
  void hold(const SparseMatrix& a);

  std::vector<Pair> pairs_;  // entries below the diagonal
};

}  // namespace flexmorph::fem
