#pragma once

#include <array>
#include <utility>
#include <vector>

#include "geometry/parts/part_mesh.h"
#include "optim/verification/loads.h"

namespace flexmorph::verification {

/// The nodes of a mesh at one pin of a link (a body between two pins).
struct PinNodes {
  std::vector<std::pair<int, double>> shares;  ///< Nodes and their shares of a force (sum 1) [-].
  Pin pin;                                     ///< Pin that the nodes belong to.
};

/// Balances the forces on a part without supports, so that their resultant force and moment vanish:
///
///   f ← f - H (Rᵀ H)⁻¹ Rᵀ f
///
/// R (2 n_nodes x 3)  displacements of the rigid motions
/// H (2 n_nodes x 3)  balancing forces: unit forces at the first pin in both directions and at the
///                    second pin perpendicular to the line of the pins, or the inertia forces of R
///
/// The reaction of a pin in a bore presses on that half of the rim that the force points to. This
/// distribution changes the moment; the formula above then balances what remains.
///
/// Source: optim/README.md, Links between two pins.
class PartBalance {
 public:
  /// Creates a balance by reactions at two pins.
  /// @throws Error (input) if both pins have the same position.
  PartBalance(const PartMesh& mesh, std::array<PinNodes, 2> pins);
  /// Creates a balance by the inertia forces of a rigid acceleration of the part.
  /// @param inertia  nodal inertia forces of the columns of rigid_motions() (2 n_nodes x 3)
  PartBalance(const PartMesh& mesh, const MatrixXd& inertia);

  /// Returns the displacements of the rigid motions (2 n_nodes x 3): translations in x and y, and a
  /// rotation about the centre of the bounding box of the mesh, divided by its diagonal.
  static MatrixXd rigid_motions(const PartMesh& mesh);

  /// Adds the balancing forces to the forces on the part.
  /// @param forces  forces at all nodes (2 n_nodes) [N]
  void apply(VectorXd& forces) const;

 private:
  MatrixXd rigid_, balancing_;
  Eigen::Matrix3d together_;  // (Rᵀ H)⁻¹
  Vec2 across_{0, 0};
  std::vector<Vec2> points_[2];
  std::array<PinNodes, 2> pins_;
};

}  // namespace flexmorph::verification
