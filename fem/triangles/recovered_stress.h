#pragma once

#include <span>
#include <vector>

#include "fem/triangles/triangle_plate.h"

namespace flexmorph::fem {

/// Recovered stresses of a few loads at the nodes, and the estimated error of the computed
/// stresses.
///
/// Around every corner of the mesh a quadratic polynomial is fitted to the stresses at the three
/// points of each triangle (superconvergent patch recovery). Its value at the corner is σ*; at the
/// middle of a side σ* is the mean of the polynomials of both ends. The square of the error of a
/// triangle in the energy norm is estimated by ∫ (σ* - σ)ᵀ D⁻¹ (σ* - σ) dV. For fixed loads the sum
/// over triangles estimates the error of the compliance: F.u - F.u_h = |u - u_h|².
///
/// For a load with a clamp only triangles in front of it are included.
///
/// Source: Zienkiewicz & Zhu (1992), IJNME 33, 1331-1364 and 1365-1382.
class RecoveredStress {
 public:
  /// Finds the triangles around every corner of a plate.
  /// @param plate  must outlive this object
  explicit RecoveredStress(const TrianglePlate& plate);

  /// Energies, errors and stresses of some loads.
  struct Outcome {
    VectorXd energies;  ///< Energy uᵀ K u of each load (n_loads) [J].
    VectorXd errors;    ///< Estimated error |u - u_h|² of each load (n_loads) [J].
    /// Contribution of each triangle to the errors (n_loads x n_triangles) [J].
    MatrixXd by_triangle;
    /// Recovered stress σ* at nodes (3 n_loads x n_nodes): σ₁₁, σ₂₂, σ₁₂ of each load [Pa].
    MatrixXd stress;
    /// Averaged stress at nodes, as most programs print it (3 n_loads x n_nodes) [Pa]: the mean
    /// over the adjacent triangles of the stress of each triangle at its nodes. It is not valid on
    /// the clamp of a load, where triangles behind the clamp contribute, too.
    MatrixXd averaged;
  };
  /// Evaluates the stresses of some loads.
  /// @param displacements  (n_loads x n_unknowns)
  /// @param clamps  clamp of each load, ascending
  /// @param prescribed  displacements of held nodes in each load (n_loads x 2 n_nodes); empty: zero
  Outcome evaluate(const MatrixXd& displacements, std::span<const int> clamps,
                   const MatrixXd& prescribed = {}) const;

 private:
  /// Returns the triangles around a corner that are in front of a clamp, and their neighbours where
  /// there are too few.
  std::vector<int> patch(int corner, int clamp) const;
  MatrixXd stresses(const MatrixXd& displacements, const MatrixXd& prescribed) const;
  void recover(const MatrixXd& stresses, std::span<const int> clamps, MatrixXd& nodal) const;
  void recover_at(int corner, std::span<const int> triangles, Eigen::Index first,
                  Eigen::Index count, const MatrixXd& stresses, MatrixXd& nodal) const;

  const TrianglePlate& plate_;
  std::vector<std::vector<int>> around_;   // triangles around every corner
  std::vector<std::vector<int>> middles_;  // middle nodes of the sides at every corner
};

}  // namespace flexmorph::fem
