#pragma once

#include <array>

#include "fem/section.h"
#include "geometry/grid.h"
#include "optim/mmc/loads/static_loads.h"

namespace flexmorph::mmc {

/// The balance of the loads of a link, which is a body of a mechanism between two pins without a
/// clamp. The class adds reactions or inertia forces that balance the loads, and selects one of the
/// displacement fields, which are determined except for a rigid motion.
///
/// With the rigid motions R of the grid (2 n_nodes x 3), loads F₀ = -M a + f become
///
///   F = F₀ - H (Rᵀ H)⁻¹ Rᵀ F₀,   Hᵀ u = 0
///
///   pins      H = unit forces along both displacements of the first pin and perpendicular to the
///             line of the pins at the second pin: statically determinate reactions
///   floating  H = M R: inertia forces of rigid accelerations c, F = f - M (a + R c),
///             Rᵀ M R c = Rᵀ (f - M a)
///
/// For this choice of u, and for no other one, u · dF = -u · dM (a + R c), although H may depend on
/// M: dF consists of components along H and of -dM (a + R c), and u · H = 0. (c = 0 for `pins`.)
///
/// Vectors of all loads are stored as matrices (n x 2 n_nodes).
///
/// Source: optim/README.md, Links between two pins.
class LinkBalance {
 public:
  /// Creates the balance of a link.
  /// @param pins     nodes of the two pins
  /// @param support  `pins` or `floating`
  /// @throws Error (input) when both pins are at one node.
  LinkBalance(const Grid& grid, const fem::PlaneSection& section, const std::array<int, 2>& pins,
              Support support);

  /// Computes the balanced forces F and the accelerations a + R c of all loads (n x 2 n_nodes).
  /// @param loads  loads that depend on the design
  /// @param mass   mass scale factors (n_cells)
  void forces(const StaticLoads& loads, const VectorXd& mass, MatrixXd& F, MatrixXd& acceleration);
  /// Subtracts a rigid motion from the displacements u (n x 2 n_nodes), so that Hᵀ u = 0.
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
