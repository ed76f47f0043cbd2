#pragma once

#include <memory>
#include <span>
#include <vector>

#include "fem/section.h"
#include "fem/solve/static_solver.h"
#include "geometry/parts/part_mesh.h"

namespace flexmorph::fem {

/// A spring between two nodes with the energy ½ k (w_b - w_a)² of one displacement component.
struct NodeSpring {
  /// Numbers of the two nodes, and the component of the displacement, x (0) or y (1).
  int a = 0, b = 0, component = 0;
  double stiffness = 0;  ///< Stiffness k [N/m].
};

/// Supports of a mesh: displacements that are held, always or for some loads, and springs between
/// nodes.
struct TrianglePlateSupports {
  std::vector<HeldUnknown> held = {};  ///< Displacements that are held for all loads.
  /// Clamp lines x = const, from the free end (largest x) to the root [m]. For a load with clamp k,
  /// nodes on line k and behind it are held. Empty: one support for all loads.
  std::vector<double> clamps = {};
  double small = 0;  ///< Distance within which a node is on a clamp [m].
  /// Flag of every triangle, 1 if it is left out; empty: all are included.
  std::vector<signed char> left_out = {};
  std::vector<NodeSpring> springs = {};  ///< Springs between nodes in front of all clamps.
};

/// Linear static analysis of a plane-stress part of six-node triangles, for many loads at once.
///
/// Unknowns are numbered so that the Cholesky factor of the plate clamped at any of the lines is a
/// leading block of one factor, as in StaticSolver; between two lines they are numbered for little
/// fill (CAMD). The factor is a SupernodalFactor, analysed once.
///
/// Source of the order: Amestoy, Davis, Duff (1996), SIAM J. Matrix Anal. Appl. 17, 886-905.
class TrianglePlate {
 public:
  /// Numbers the unknowns and analyses the pattern of the stiffness.
  /// @param mesh  must outlive this object
  /// @throws Error (input) when no unknown is left.
  TrianglePlate(const PartMesh& mesh, const PlaneSection& section, TrianglePlateSupports supports);
  ~TrianglePlate();
  TrianglePlate(TrianglePlate&&) noexcept;

  /// Returns the mesh of the part.
  const PartMesh& mesh() const;
  /// Returns material and thickness.
  const PlaneSection& section() const;
  /// Returns the number of unknown displacements.
  int n_unknowns() const;
  /// Returns the unknown of a displacement, or -1.
  int row(int node, int component) const;
  /// Returns true if a triangle is included in the analysis.
  bool takes_part(std::size_t triangle) const;
  /// Returns the first clamp that a node is in front of; n_clamps() where there is none; 0 for all
  /// nodes if there are no clamp lines.
  int first_clamp(int node) const;
  /// Returns the first clamp that a triangle is in front of (the clamp may be one of its sides);
  /// n_clamps() where there is none; 0 for all triangles if there are no clamp lines.
  int first_clamp(std::size_t triangle) const;
  /// Returns the number of clamps; 1 if there are no clamp lines.
  int n_clamps() const;

  /// Assembles and factors the stiffness K.
  /// @throws Error (numerical) when K is not positive definite.
  void factorize();
  /// Solves K u = F in place (n_loads x n_unknowns). Entries of a load that are not in front of its
  /// clamp are ignored and set to 0.
  /// @param clamps  clamp of each load, ascending
  void solve(MatrixXd& loads, std::span<const int> clamps) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace flexmorph::fem
