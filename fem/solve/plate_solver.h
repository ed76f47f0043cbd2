#pragma once

#include <Eigen/SparseCore>
#include <memory>
#include <span>
#include <vector>

#include "fem/section.h"
#include "geometry/grid.h"

namespace flexmorph::fem {

/// A displacement that is held at zero: of a node in x (0) or y (1).
struct HeldUnknown {
  int node = 0, component = 0;
};

/// Linear static analysis of a plane-stress plate at rest on a regular grid: any displacements may
/// be held, any cells may lie outside of the domain (they do not exist; a node that touches no
/// cell of the domain has no unknowns).
///
/// Nodes are numbered by nested dissection of the grid, the Cholesky factor is analysed once, see
/// SupernodalFactor; many right-hand sides are solved at once, the values of all loads at one
/// unknown next to each other.
///
/// For a plate whose clamp moves along the grid see StaticSolver: one factor serves all clamps
/// there, at the price of a band as wide as the plate.
class PlateSolver {
 public:
  /// @param outside  1 for cells outside of the domain (n_cells); empty: all are inside
  /// @throws Error (input) when nothing is left or a held unknown is not one of the grid's.
  PlateSolver(const Grid& grid, const PlaneSection& section, std::span<const HeldUnknown> held,
              std::span<const signed char> outside = {});
  ~PlateSolver();
  PlateSolver(PlateSolver&&) noexcept;

  const Grid& grid() const;
  int n_unknowns() const;
  /// Place of a displacement among the unknowns, or -1 when it is held or its node has none.
  int row(int node, int component) const;

  /// K(stiffness factors (n_cells)), factored. Cells outside of the domain are not read.
  /// @throws Error (numerical) when K is not positive definite or a factor is not finite.
  void factorize(const VectorXd& stiffness_factor);
  /// condition_estimate() of K of the last factorize().
  double condition() const;

  /// Solves in place: (n_loads x n_unknowns).
  void solve(MatrixXd& loads) const;
  /// L⁻¹ loads, in place: |L⁻¹ F|² = F . K⁻¹ F.
  void forward(MatrixXd& loads) const;

  /// Σ_l w_l u_l . K_cell u_l of full material for every cell (n_cells); 0 outside.
  void cell_energies(const MatrixXd& displacements, const VectorXd& weights,
                     VectorXd& energies) const;
  /// K_i u, K_i = Σ_c D_ci K_c of full material, for every column of D, in place of the rows of
  /// `forces` (n_directions x n_unknowns).
  /// @param displacements  u (n_unknowns)
  /// @param directions  D (n_cells x n_directions); cells outside of the domain are not read
  void cell_forces(const VectorXd& displacements, const Eigen::SparseMatrix<double>& directions,
                   MatrixXd& forces) const;
  /// u_l . K_cell u_l of every load (n_loads x n_cells).
  void cell_energies(const MatrixXd& displacements, MatrixXd& energies) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace flexmorph::fem
