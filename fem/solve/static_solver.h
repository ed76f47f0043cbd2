#pragma once

#include <Eigen/SparseCore>
#include <memory>
#include <span>
#include <vector>

#include "fem/section.h"
#include "fem/solve/q4_cell.h"
#include "geometry/grid.h"

namespace flexmorph::fem {

/// A displacement that is held at zero.
struct HeldUnknown {
  /// Number of the node and direction of the displacement, x (0) or y (1).
  int node = 0, component = 0;
};

/// Linear static analysis of a plane-stress plate on a regular grid, for many right-hand sides.
///
/// Right-hand sides and displacements are (n_loads x n_unknowns): column = unknown, so that the
/// values of all loads at one unknown lie next to each other. The pattern of the Cholesky factor is
/// analysed once (SupernodalFactor); two orders of the unknowns serve two kinds of support:
///
///   clamp     A column of nodes is held, a different one for each load if desired. Unknowns are
///   numbered
///             column by column from the free end (largest i) to the root, so that the factor of
///             the plate clamped at any column is a leading block of one factor: one factorization
///             serves all root columns (fem/README.md, Static solver). Loads may come in any order;
///             where their root columns are monotone (times in order), no rows are moved.
///   supports  Any displacements may be held and any cells may lie outside of the domain. Nodes are
///             numbered by nested dissection of the grid.
///
/// The work space belongs to the object, so that only one thread at a time may use it.
class StaticSolver {
 public:
  /// Creates a plate with a clamp. The displacements of all nodes between column first_root and the
  /// free end are unknown (column first_root itself is held); the root columns of loads are in
  /// [first_root, nx].
  /// @param edge_stiffness  κ [N/m] of a penalty on column nx, κ Σ_j ((v_j+1 - v_j)² + (u_j+1 - u_j
  ///     - (u_ny - u_0) / ny)²) / 2, which keeps it straight and its width constant and is included
  ///     in K; 0: no penalty
  /// @throws Error (input) when first_root is not in [0, nx), or κ is negative or not finite.
  StaticSolver(const Grid& grid, const PlaneSection& section, int first_root = 0,
               double edge_stiffness = 0);
  /// Creates a plate on supports. A node that touches no cell of the domain has no unknowns.
  /// @param outside  1 for cells outside of the domain (n_cells); empty: all are inside
  /// @throws Error (input) when no unknown is left or a held displacement does not belong to the
  ///     grid.
  StaticSolver(const Grid& grid, const PlaneSection& section, std::span<const HeldUnknown> held,
               std::span<const signed char> outside = {});
  ~StaticSolver();
  StaticSolver(StaticSolver&&) noexcept;

  /// Returns the grid of cells.
  const Grid& grid() const;
  /// Returns material and thickness of the plate.
  const PlaneSection& section() const;
  /// Returns the penalty κ on the edge [N/m].
  double edge_stiffness() const;
  /// Returns true if the cell is inside of the domain and in front of first_root.
  bool has_cell(int cell) const;
  /// Returns the number of unknown displacements.
  int n_unknowns() const;
  /// Returns the unknown of every displacement, x of node k at 2 k and y at 2 k + 1 (2 n_nodes); -1
  /// if the displacement is held or the node has no unknowns. Both unknowns of a node are
  /// consecutive.
  std::span<const int> rows() const;
  /// Returns the unknown of a displacement, or -1.
  int row(int node, int component) const {
    return rows()[2 * static_cast<std::size_t>(node) + static_cast<std::size_t>(component)];
  }

  /// Assembles and factors K for the stiffness scale factors of the cells (n_cells). Entries of
  /// cells outside of the domain are not read.
  /// @throws Error (numerical) when K is not positive definite or a factor is not finite.
  void factorize(const VectorXd& stiffness_factor);
  /// Returns condition_estimate() of K of the last factorize().
  double condition() const;

  /// Solves K u = F in place. Load l is clamped at root_columns[l]: its entries on and behind the
  /// clamp are ignored and set to 0. Without root columns only the supports hold the plate.
  /// @throws Error (input) unless there is one root column in [first_root, nx] per load.
  void solve(MatrixXd& loads, std::span<const int> root_columns = {}) const;

  /// Solves for loads that act only on the column of nodes in front of their clamp, as those of a
  /// moving clamp do; this halves the work.
  void solve_at_clamp(MatrixXd& loads, std::span<const int> root_columns) const;

  /// Solves for loads = mix * basis (mix (n_loads x r), basis (r x n_unknowns)), except for entries
  /// behind each load's clamp, by r forward substitutions instead of n_loads. `basis` is
  /// overwritten with L⁻¹ basis.
  void solve_mixed(const MatrixXd& mix, MatrixXd& basis, std::span<const int> root_columns,
                   MatrixXd& displacements) const;

  /// Computes L⁻¹ loads in place; |L⁻¹ F|² = F . K⁻¹ F. With root columns the entries on and behind
  /// the clamp of each load are meaningless.
  void forward(MatrixXd& loads, std::span<const int> root_columns = {}) const;

  /// Computes Σ_l w_l u_l . K_cell u_l of full material for every cell (n_cells); 0 outside of the
  /// domain.
  /// @param root_columns  when given, displacements on and behind them are zero by definition and
  ///     are not read.
  void cell_energies(const MatrixXd& displacements, const VectorXd& weights, VectorXd& energies,
                     std::span<const int> root_columns = {}) const;
  /// Computes u_l . K_cell u_l of full material for every load and cell (n_loads x n_cells).
  void cell_energies(const MatrixXd& displacements, MatrixXd& energies) const;

  /// Returns twice the energy of the penalty on the edge, summed over loads with weights [J].
  double edge_energy(const MatrixXd& displacements, const VectorXd& weights) const;

  /// Computes K u of the cells with the given stiffness scale factors, without the penalty on the
  /// edge (n_loads x n_unknowns).
  void apply(const VectorXd& stiffness_factor, const MatrixXd& displacements,
             MatrixXd& forces) const;
  /// Computes K_i u, K_i = Σ_c D_ci K_c of full material, for every column i of D. The result
  /// replaces `forces` (n_directions x n_unknowns).
  /// @param displacements  u (n_unknowns)
  /// @param directions  D (n_cells x n_directions); entries of cells outside of the domain are not
  ///     read
  void cell_forces(const VectorXd& displacements, const Eigen::SparseMatrix<double>& directions,
                   MatrixXd& forces) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace flexmorph::fem
