#pragma once

#include <array>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "fem/section.h"
#include "fem/solve/factorization/supernodal_factor.h"
#include "geometry/grid.h"

namespace flexmorph::fem {

/// Stiffness matrix of bilinear plane-stress cells of a grid with its Cholesky factor, for unknowns
/// in any order. The two orders that StaticSolver uses differ considerably in cost (fem/README.md,
/// Static solver).
class Q4Matrix {
 public:
  /// Analyses the pattern of the stiffness matrix.
  /// @param cells  cells that have stiffness, ascending
  /// @param rows  unknown of every displacement, x of node k at 2 k and y at 2 k + 1: -1 when it is
  ///     held or does not exist; every number from 0 on occurs once
  /// @param further  one additional entry of the pattern, row and column (row > column)
  Q4Matrix(const Grid& grid, const PlaneSection& section, std::vector<int> cells,
           std::vector<int> rows, std::optional<std::pair<int, int>> further = {});

  /// Returns the number of unknowns.
  int size() const { return static_cast<int>(displacement_of_.size()); }
  /// Returns the unknown of every displacement, or -1 (2 n_nodes).
  std::span<const int> rows() const { return rows_; }
  /// Returns the displacement of an unknown, 2 node + component.
  int displacement_of(int unknown) const {
    return displacement_of_[static_cast<std::size_t>(unknown)];
  }
  /// Returns the unknowns of the corners of cell (i, j), x and y interleaved.
  std::array<int, 8> rows_of_cell(int i, int j) const {
    const int* left = &rows_[2 * static_cast<std::size_t>(grid_.node(i, j))];
    const int* right = left + 2 * (grid_.ny + 1);
    return {left[0], left[1], right[0], right[1], right[2], right[3], left[2], left[3]};
  }
  /// Returns the stiffness of a cell of full material [N/m].
  const Eigen::Matrix<double, 8, 8>& cell_stiffness() const { return cell_stiffness_; }

  /// Returns the index in the pattern of the entry of unknowns a >= b of a cell, given by its index
  /// in `cells`; -1 if one of them is held.
  int entry(std::size_t value_index, std::size_t a, std::size_t b) const {
    return scatter_[36 * value_index + a * (a + 1) / 2 + b];
  }
  /// Returns the index in the pattern of the additional entry `further`; -1 without it.
  int further_entry() const { return further_entry_; }

  /// Assembles K for the stiffness scale factors of the cells (n_cells) and returns its values in
  /// the order of the pattern; factor().factorize() factors them.
  std::span<double> assemble(const VectorXd& stiffness_factor);
  /// Returns the Cholesky factor.
  SupernodalFactor& factor() { return factor_; }
  const SupernodalFactor& factor() const { return factor_; }

 private:
  void unknowns_around(int node, int first, std::span<const char> inside,
                       std::vector<int>& out) const;
  SupernodalFactor pattern(std::optional<std::pair<int, int>> further);

  Grid grid_;
  Eigen::Matrix<double, 8, 8> cell_stiffness_;
  std::vector<int> cells_, rows_, displacement_of_;
  std::vector<int> scatter_;  // index in the pattern by cell and pair of unknowns (36)
  int further_entry_ = -1;
  SupernodalFactor factor_;
};

}  // namespace flexmorph::fem
