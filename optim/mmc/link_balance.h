#pragma once

#include <array>

#include "fem/section.h"
#include "geometry/grid.h"
#include "optim/mmc/compliance.h"

namespace flexmorph::mmc {

/// What balances the loads of a link between two pins, and which of the displacements that differ
/// by a rigid motion is meant.
///
/// With R the rigid motions of the grid (2 n_nodes x 3), loads F₀ = -M a + f become
///
///   F = F₀ - H (Rᵀ H)⁻¹ Rᵀ F₀,   Hᵀ u = 0
///
///   pins      H = unit forces at both displacements of the first pin and across the line of the
///             pins at the second one: their reactions, which determine themselves
///   floating  H = M R: rigid accelerations c, F = f - M (a + R c), Rᵀ M R c = Rᵀ (f - M a)
///
/// In this choice of u, and in no other, u · dF = -u · dM (a + R c), although H may depend on M:
/// dF has parts along H and along dM R only, and u · H = 0. (c = 0 for `pins`.)
///
/// Vectors of all loads are matrices (n x 2 n_nodes).
///
/// Source: optim/README.md, Links between two pins.
class LinkBalance {
 public:
  /// @param support  pins or floating
  /// @throws Error (input) for pins at one place.
  LinkBalance(const Grid& grid, const fem::PlaneSection& section, const std::array<int, 2>& pins,
              Support support);

  /// M of a design. @param mass  factors (n_cells)
  void set_mass(const VectorXd& mass);
  /// -M a (n x 2 n_nodes).
  void inertia_forces(const MatrixXd& acceleration, MatrixXd& F) const;
  /// F₀ -> F, and a -> a + R c.
  void balance(MatrixXd& F, MatrixXd& acceleration) const;
  /// u -> the one with Hᵀ u = 0.
  void choose(MatrixXd& u) const;
  /// Σ_l w_l z_l · M_cell a_l of full mass for every cell (n_cells).
  void products(const MatrixXd& z, const MatrixXd& a, const VectorXd& weights,
                VectorXd& product) const;
  /// The same of every load by itself (n x n_cells).
  void products(const MatrixXd& z, const MatrixXd& a, MatrixXd& product) const;

 private:
  template <class Use>
  void each_cell(Use use) const;  // use(cell, its four nodes)

  Grid grid_;
  fem::PlaneSection section_;
  Eigen::Matrix4d cell_mass_;
  Support support_;
  VectorXd mass_;
  MatrixXd rigid_, held_;     // R, H (2 n_nodes x 3)
  Eigen::Matrix3d together_;  // (Rᵀ H)⁻¹
};

}  // namespace flexmorph::mmc
