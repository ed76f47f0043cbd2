#pragma once

#include <Eigen/SparseCore>
#include <memory>
#include <span>
#include <vector>

#include "fem/section.h"
#include "fem/solve/q4_cell.h"
#include "geometry/grid.h"

namespace flexmorph::fem {

/// A displacement that is held at zero: of a node in x (0) or y (1).
struct HeldUnknown {
  int node = 0, component = 0;
};

/// Linear static analysis of a plane-stress plate on a regular grid, for many right-hand sides.
///
/// Right-hand sides and displacements are (n_loads x n_unknowns): column = unknown, so that the
/// values of all loads at one unknown lie next to each other. The pattern of the Cholesky factor is
/// analysed once (SupernodalFactor); two orders of the unknowns serve two kinds of support:
///
///   clamp     A column of nodes that may be another one for every load. Unknowns are numbered
///             column by column from the free end (largest i) to the root, so that the factor of
///             the plate clamped at any column is a leading block of one factor: one factorization
///             serves all root columns (fem/README.md, Static solver). Loads may come in any order;
///             where their root columns are monotone (times in order), no rows are moved.
///   supports  Any displacements are held, any cells may lie outside of the domain. Nodes are
///             numbered by nested dissection of the grid.
///
/// Work space belongs to the object: one thread at a time.
class StaticSolver {
 public:
  /// A plate with a clamp. Everything between column `first_root` of nodes and the free end is
  /// unknown (column first_root itself is held); root columns of loads are in [first_root, nx].
  /// @param edge_stiffness  κ [N/m]: column nx is kept straight and as wide as it is by
  ///        κ Σ_j ((v_j+1 - v_j)² + (u_j+1 - u_j - (u_ny - u_0) / ny)²) / 2, which is part of K; 0:
  ///        nothing keeps it
  /// @throws Error (input) when first_root is not in [0, nx), or κ is negative or not finite.
  StaticSolver(const Grid& grid, const PlaneSection& section, int first_root = 0,
               double edge_stiffness = 0);
  /// A plate on supports. A node that touches no cell of the domain has no unknowns.
  /// @param outside  1 for cells outside of the domain (n_cells); empty: all are inside
  /// @throws Error (input) when nothing is left or a held unknown is not one of the grid's.
  StaticSolver(const Grid& grid, const PlaneSection& section, std::span<const HeldUnknown> held,
               std::span<const signed char> outside = {});
  ~StaticSolver();
  StaticSolver(StaticSolver&&) noexcept;

  const Grid& grid() const;
  const PlaneSection& section() const;
  double edge_stiffness() const;  ///< κ [N/m]
  bool has_cell(int cell) const;  ///< Is the cell inside of the domain, in front of first_root?
  int n_unknowns() const;
  /// Unknown of every displacement, x of node k at 2 k and y at 2 k + 1 (2 n_nodes); -1: it is
  /// held, or its node has none. Both unknowns of a node follow each other.
  std::span<const int> rows() const;
  /// Unknown of a displacement, or -1.
  int row(int node, int component) const {
    return rows()[2 * static_cast<std::size_t>(node) + static_cast<std::size_t>(component)];
  }

  /// K(stiffness scale factors (n_cells)), factored. Cells that do not exist are not read.
  /// @throws Error (numerical) when K is not positive definite or a factor is not finite.
  void factorize(const VectorXd& stiffness_factor);
  /// condition_estimate() of K of the last factorize().
  double condition() const;

  /// Solves K u = F in place. Load l is clamped at root_columns[l]: its entries on and behind the
  /// clamp are ignored and come back 0. Without root columns nothing but the supports holds loads.
  /// @throws Error (input) for root columns that are not one in [first_root, nx] per load.
  void solve(MatrixXd& loads, std::span<const int> root_columns = {}) const;

  /// Solves for loads that act on the column of nodes in front of their clamp only, as a clamp does
  /// that moves: half the work.
  void solve_at_clamp(MatrixXd& loads, std::span<const int> root_columns) const;

  /// Solves for loads = mix * basis (mix (n_loads x r), basis (r x n_unknowns)) up to entries
  /// behind each load's clamp: r forward substitutions instead of n_loads. `basis` comes back as
  /// L⁻¹ basis.
  void solve_mixed(const MatrixXd& mix, MatrixXd& basis, std::span<const int> root_columns,
                   MatrixXd& displacements) const;

  /// L⁻¹ loads, in place: |L⁻¹ F|² = F . K⁻¹ F. With root columns up to the clamp of each load:
  /// what comes back on and behind it has no meaning.
  void forward(MatrixXd& loads, std::span<const int> root_columns = {}) const;

  /// Σ_l w_l u_l . K_cell u_l of full material for every cell (n_cells); 0 outside of the domain.
  /// @param root_columns  when given, displacements are known to be zero on and behind them, and
  ///        these entries are not read.
  void cell_energies(const MatrixXd& displacements, const VectorXd& weights, VectorXd& energies,
                     std::span<const int> root_columns = {}) const;
  /// u_l . K_cell u_l of full material for every load and cell (n_loads x n_cells).
  void cell_energies(const MatrixXd& displacements, MatrixXd& energies) const;

  /// Twice the energy of what keeps the edge, summed over loads with weights [J].
  double edge_energy(const MatrixXd& displacements, const VectorXd& weights) const;

  /// K u of the cells alone with these stiffness scale factors (n_loads x n_unknowns).
  void apply(const VectorXd& stiffness_factor, const MatrixXd& displacements,
             MatrixXd& forces) const;
  /// K_i u, K_i = Σ_c D_ci K_c of full material, for every column of D, in place of the rows of
  /// `forces` (n_directions x n_unknowns).
  /// @param displacements  u (n_unknowns)
  /// @param directions  D (n_cells x n_directions); cells that do not exist are not read
  void cell_forces(const VectorXd& displacements, const Eigen::SparseMatrix<double>& directions,
                   MatrixXd& forces) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace flexmorph::fem
