#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace flexmorph::fem {

/// Storage scheme of the Cholesky factor of a sparse matrix: blocks of neighbouring columns that
/// share their rows (supernodes), and the order in which the blocks can be computed.
///
/// Block s contains the columns [first[s], first[s + 1]) of L; its rows are these columns, then
/// below(s), ascending. It is dense, by columns, at offset[s] of the values. `in_parent` and
/// `run_end` have one entry for each of `rows`; run_end counts from the block's first row below.
struct Supernodes {
  std::vector<int> first;           ///< First columns of the blocks (n_blocks + 1).
  std::vector<std::size_t> offset;  ///< Start of each block in the values (n_blocks + 1).
  std::vector<int> row_starts;      ///< Start of each block in `rows` (n_blocks + 1).
  std::vector<int> rows;            ///< Rows below the triangles.
  std::vector<int> in_parent;       ///< Index of each of `rows` among the rows of the parent.
  std::vector<int> run_end;  ///< End of the run of rows that are consecutive in the parent too.
  /// Block that contains the first row below as a column (n_blocks); -1: no row below, or it
  /// belongs to the border.
  std::vector<int> parent;
  std::vector<int> order;  ///< Order of computation, depth first: children before parents.
  std::vector<std::size_t> value_index;  ///< Index of every entry of the matrix in the values.
  std::size_t deepest_stack = 0;         ///< Largest number of stored update entries in `order`.

  /// Returns the number of blocks.
  int n_blocks() const { return static_cast<int>(parent.size()); }
  /// Returns the number of columns of a block.
  int width(int s) const { return first[at(s) + 1] - first[at(s)]; }
  /// Returns the number of rows below the triangle of a block.
  int n_below(int s) const { return row_starts[at(s) + 1] - row_starts[at(s)]; }
  /// Returns the number of rows of a block.
  int height(int s) const { return width(s) + n_below(s); }
  /// Returns the rows below the triangle of a block (n_below).
  const int* below(int s) const { return rows.data() + row_starts[at(s)]; }

 private:
  static std::size_t at(int s) { return static_cast<std::size_t>(s); }
};

/// Analyses a pattern by CHOLMOD in the given order of the unknowns.
///
/// @param starts, rows  lower triangle by compressed columns, rows ascending, diagonal first; rows
///     beyond the columns belong to a border that is not eliminated
/// @throws Error (numerical) when CHOLMOD fails, for instance for lack of memory.
Supernodes find_supernodes(std::span<const int> starts, std::span<const int> rows);

}  // namespace flexmorph::fem
