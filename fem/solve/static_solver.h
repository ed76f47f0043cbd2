#pragma once

#include <memory>
#include <span>
#include <vector>

#include "fem/section.h"
#include "fem/solve/q4_cell.h"
#include "geometry/grid.h"

namespace flexmorph::fem {

/// Linear static analysis of a plate on a regular grid, clamped along a column of nodes that may
/// be another one for every load.
///
/// Unknowns are numbered column by column from the free end (largest i) to the root, so that the
/// Cholesky factor of the plate clamped at any column is a leading block of one factor: one
/// factorization serves all root columns (fem/README.md, Static solver). SupernodalFactor, natural
/// order, analysed once; many right-hand sides are solved at once, unknown by unknown next to each
/// other.
///
/// Loads may come in any order; when their root columns are monotone (times in order), no rows
/// are moved. Work space belongs to the object: one thread at a time.
class StaticSolver {
 public:
  /// Everything behind column `first_root` of nodes to the free end is unknown (column first_root
  /// itself is held); root columns of the loads are in [first_root, nx].
  /// @param edge_stiffness  κ [N/m]: column nx is kept straight and as wide as it is by
  ///        κ Σ_j ((v_j+1 - v_j)² + (u_j+1 - u_j - (u_ny - u_0) / ny)²) / 2, which is part of K; 0:
  ///        nothing keeps it
  /// @throws Error (input) when first_root is not in [0, nx), or κ is negative or not finite.
  StaticSolver(const Grid& grid, const PlaneSection& section, int first_root = 0,
               double edge_stiffness = 0);
  ~StaticSolver();
  StaticSolver(StaticSolver&&) noexcept;

  const Grid& grid() const;
  int n_unknowns() const;  ///< 2 (ny + 1) (nx - first_root)

  /// Row of a node's x-displacement among the unknowns (y: + 1), or -1 when the node is held.
  int row(int i, int j) const;

  /// K(stiffness factors (n_cells)), factored. Cells behind column first_root are not read.
  /// @throws Error (numerical) when K is not positive definite or a factor is not finite.
  void factorize(const VectorXd& stiffness_factor);
  /// condition_estimate() of K of the last factorize().
  double condition() const;

  /// Solves in place. `loads` is (n_loads x n_unknowns): column = unknown, so that the values of
  /// all loads at one unknown lie next to each other. Load l is clamped at root_columns[l]; its
  /// entries on and behind the clamp are ignored and come back 0.
  void solve(MatrixXd& loads, std::span<const int> root_columns) const;

  /// The same for loads that act on the column of nodes in front of their clamp only, as a clamp
  /// does that moves: half the work.
  void solve_at_clamp(MatrixXd& loads, std::span<const int> root_columns) const;

  /// The same when loads = mix * basis (mix (n_loads x r), basis (r x n_unknowns)) up to entries
  /// behind each load's clamp: r forward substitutions instead of n_loads. `basis` comes back as
  /// L⁻¹ basis.
  void solve_mixed(const MatrixXd& mix, MatrixXd& basis, std::span<const int> root_columns,
                   MatrixXd& displacements) const;

  /// L⁻¹ loads, in place, of the plate clamped at column first_root: |L⁻¹ F|² = F . K⁻¹ F.
  void forward(MatrixXd& loads) const;
  /// The same up to the clamp of each load: what comes back on and behind it means nothing.
  void forward(MatrixXd& loads, std::span<const int> root_columns) const;

  /// u . K_cell u of full material for every cell, summed over loads with weights (n_cells).
  /// @param root_columns  when given, displacements are known to be zero on and behind them, and
  ///        these entries are not read.
  void cell_energies(const MatrixXd& displacements, const VectorXd& weights, VectorXd& energies,
                     std::span<const int> root_columns = {}) const;

  /// Twice the energy of what keeps the edge, summed over loads with weights [J].
  double edge_energy(const MatrixXd& displacements, const VectorXd& weights) const;

  /// K u of the cells alone, with the factors of the last factorize() (n_loads x
  /// n_unknowns).
  void apply(const MatrixXd& displacements, MatrixXd& forces) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace flexmorph::fem
