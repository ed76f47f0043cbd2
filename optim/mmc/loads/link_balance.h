#pragma once

#include <array>

#include "fem/section.h"
#include "geometry/grid.h"
#include "optim/mmc/loads/static_loads.h"

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

  /// F = -M a + f of all displacements, balanced, and a -> a + R c.
  /// @param mass  factors (n_cells)   @param loads  that follow the design
  void forces(const StaticLoads& loads, const VectorXd& mass, MatrixXd& F, MatrixXd& acceleration);
  /// Takes off the rigid motion of u that leaves Hᵀ u = 0.
  void choose(MatrixXd& u) const;

 private:
  void set_mass(const VectorXd& mass);
  void inertia_forces(const VectorXd& mass, const MatrixXd& acceleration, MatrixXd& F) const;

  Grid grid_;
  Eigen::Matrix4d cell_mass_;
  Support support_;
  MatrixXd rigid_, held_;     // R, H (2 n_nodes x 3)
  Eigen::Matrix3d together_;  // (Rᵀ H)⁻¹
};

}  // namespace flexmorph::mmc
