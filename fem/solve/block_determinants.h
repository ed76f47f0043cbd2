#pragma once

#include <vector>

#include "fem/dofs.h"

namespace flexmorph::fem {

/// Sign and size of a determinant, which may be too small or too large for a number.
struct Determinant {
  int sign = 0;          ///< 1 or -1; 0 if the matrix is singular.
  double logarithm = 0;  ///< Natural logarithm of the absolute value; -infinity if singular.
};

/// Returns the number of the first block that comes to another branch, or near one, in a step: its
/// determinant has another sign at the end or in the middle than at the start, or is smaller in the
/// middle than 0.3 times its values at both ends. The middle is the mean of the positions at both
/// ends. Blocks that are singular at the start are not compared. Returns -1 if there is no such
/// block.
int block_near_other_branch(const std::vector<Determinant>& start,
                            const std::vector<Determinant>& middle,
                            const std::vector<Determinant>& end);

/// Determinants of the diagonal blocks of a square sparse matrix.
///
/// Permutations of rows and columns make the matrix block triangular, with as many blocks as the
/// pattern allows (Duff & Reid 1978: ACM Trans. Math. Softw. 4, 137-147). In the Jacobian of the
/// constraints of a mechanism, each block is a set of joints and bodies that are determined
/// together: a driven body, or a group of bodies in closed loops (Assur group). The determinant of
/// a block changes its sign where the group passes a singular position.
class BlockDeterminants {
 public:
  /// Finds the blocks of a compressed square matrix from its pattern.
  /// @throws Error (numerical) if KLU fails.
  void analyze(const SparseMatrix& a);
  /// Returns the number of blocks.
  int n_blocks() const { return static_cast<int>(first_.size()) - 1; }
  /// Returns the rows of a block.
  std::vector<int> rows_of(int block) const;
  /// Computes the determinants of all blocks of a matrix with the analysed pattern.
  std::vector<Determinant> of(const SparseMatrix& a) const;

 private:
  std::vector<int> rows_, index_of_row_, columns_;  // permutations, and the inverse of the first
  std::vector<int> first_ = {0};                    // first index of every block, and their number
};

}  // namespace flexmorph::fem
