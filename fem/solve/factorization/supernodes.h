#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace flexmorph::fem {

/// How the Cholesky factor of a sparse matrix is stored: blocks of neighbouring columns that share
/// their rows (supernodes), and the order in which the blocks can be computed.
///
/// Block s holds columns [first[s], first[s + 1]) of L; its rows are these columns and then
/// below(s), ascending. It is dense, by columns, at offset[s] of the values. `in_parent` and
/// `run_end` go with `rows`; run_end counts from the block's first row below.
struct Supernodes {
  std::vector<int> first;           ///< columns (n_blocks + 1)
  std::vector<std::size_t> offset;  ///< of the values (n_blocks + 1)
  std::vector<int> row_starts;      ///< of `rows` (n_blocks + 1)
  std::vector<int> rows;            ///< rows below the triangles
  std::vector<int> in_parent;       ///< place of each of `rows` among the rows of the parent
  std::vector<int> run_end;         ///< rows from each to here are neighbours in the parent too
  std::vector<int> parent;          ///< block of the first row below, -1: none (n_blocks),
                                    ///< or in the border
  std::vector<int> order;           ///< children before parents, each next to its family
  std::vector<std::size_t> place;   ///< of every entry of the matrix among the values
  std::size_t deepest_stack = 0;    ///< most numbers that updates take when computed in `order`

  int n_blocks() const { return static_cast<int>(parent.size()); }
  int width(int s) const { return first[at(s) + 1] - first[at(s)]; }
  int n_below(int s) const { return row_starts[at(s) + 1] - row_starts[at(s)]; }
  int height(int s) const { return width(s) + n_below(s); }
  const int* below(int s) const { return rows.data() + row_starts[at(s)]; }

 private:
  static std::size_t at(int s) { return static_cast<std::size_t>(s); }
};

/// Analysis by CHOLMOD in the given order of the unknowns.
///
/// @param starts, rows  lower triangle by compressed columns, rows ascending, diagonal first; rows
///                      beyond the columns belong to a border that is not eliminated
/// @throws Error (numerical) when CHOLMOD cannot, for lack of memory say.
Supernodes find_supernodes(std::span<const int> starts, std::span<const int> rows);

}  // namespace flexmorph::fem
