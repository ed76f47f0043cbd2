#pragma once

#include <array>
#include <utility>
#include <vector>

#include "geometry/parts/part_mesh.h"
#include "optim/verification/loads.h"

namespace flexmorph::verification {

/// A pin on one mesh of a part: nodes with their shares of an even force (sum 1).
struct PinNodes {
  std::vector<std::pair<int, double>> shares;
  Pin pin;
};

/// Makes the forces on a part that nothing holds balance: their sum and their moment vanish.
///
///   f ← f - H (Rᵀ H)⁻¹ Rᵀ f
///
/// R (2 n_nodes x 3)  displacements of the rigid motions
/// H (2 n_nodes x 3)  what balances: unit forces at both directions of the first pin and across the
///                    line of the pins at the second one, or the inertia forces of R
///
/// Reactions at a bore press on the half of its rim before them; what that moves their moment by is
/// balanced as before.
///
/// Source: optim/README.md, Links between two pins.
class PartBalance {
 public:
  /// Reactions at two pins. @throws Error (input) for pins at one place
  PartBalance(const PartMesh& mesh, std::array<PinNodes, 2> pins);
  /// The part accelerates as a whole.
  /// @param inertia  nodal inertia forces of the columns of rigid_motions() (2 n_nodes x 3)
  PartBalance(const PartMesh& mesh, const MatrixXd& inertia);

  /// Shifts in x and y and a turn about the middle of the mesh (2 n_nodes x 3).
  static MatrixXd rigid_motions(const PartMesh& mesh);

  /// @param forces  at all nodes (2 n_nodes) [N]
  void apply(VectorXd& forces) const;

 private:
  MatrixXd rigid_, balancing_;
  Eigen::Matrix3d together_;  // (Rᵀ H)⁻¹
  Vec2 across_{0, 0};
  std::vector<Vec2> points_[2];
  std::array<PinNodes, 2> pins_;
};

}  // namespace flexmorph::verification
