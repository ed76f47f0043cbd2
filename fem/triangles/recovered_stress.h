#pragma once

#include <span>
#include <vector>

#include "fem/triangles/triangle_plate.h"

namespace flexmorph::fem {

/// What stresses of a few loads say: recovered ones at the nodes, and how far the computed ones are
/// from them.
///
/// Around every corner of the mesh a quadratic polynomial is fitted to the stresses at the three
/// points of each triangle (superconvergent patch recovery); its values are σ* at the corner and,
/// the mean of those of both ends, at middles of sides. The error of a triangle in the energy norm,
/// squared, is estimated by ∫ (σ* - σ)ᵀ D⁻¹ (σ* - σ) dV. For fixed loads the sum over triangles
/// estimates the compliance that is missing: F.u - F.u_h = |u - u_h|².
///
/// Of a load with a clamp only triangles in front of it count.
///
/// Source: Zienkiewicz & Zhu (1992), IJNME 33, 1331-1364 and 1365-1382.
class RecoveredStress {
 public:
  /// @param plate  lives longer
  explicit RecoveredStress(const TrianglePlate& plate);

  struct Outcome {
    VectorXd energies;     ///< uᵀ K u of each load (n_loads) [J]
    VectorXd errors;       ///< estimated |u - u_h|² (n_loads) [J]
    MatrixXd by_triangle;  ///< its parts (n_loads x n_triangles) [J]
    MatrixXd stress;  ///< σ* at nodes (3 n_loads x n_nodes): σ₁₁, σ₂₂, σ₁₂ of each load [Pa]
    /// The same as most programs print it: σ of each triangle at its nodes, the mean of all around.
    /// Not on a clamp of a load, where what is behind it counts as well.
    MatrixXd averaged;
  };
  /// @param displacements  (n_loads x n_unknowns)   @param clamps  of the loads, ascending
  /// @param prescribed     of held nodes in each load (n_loads x 2 n_nodes); empty: zero
  Outcome evaluate(const MatrixXd& displacements, std::span<const int> clamps,
                   const MatrixXd& prescribed = {}) const;

 private:
  /// The triangles around a corner that are in front of a clamp, or a little further where these
  /// are too few.
  std::vector<int> patch(int corner, int clamp) const;
  MatrixXd stresses(const MatrixXd& displacements, const MatrixXd& prescribed) const;
  void recover(const MatrixXd& stresses, std::span<const int> clamps, MatrixXd& nodal) const;
  void recover_at(int corner, std::span<const int> triangles, Eigen::Index first,
                  Eigen::Index count, const MatrixXd& stresses, MatrixXd& nodal) const;

  const TrianglePlate& plate_;
  std::vector<std::vector<int>> around_;   // triangles, of corners
  std::vector<std::vector<int>> middles_;  // nodes halfway to other corners, of corners
};

}  // namespace flexmorph::fem
