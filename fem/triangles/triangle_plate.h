#pragma once

#include <memory>
#include <span>
#include <vector>

#include "fem/section.h"
#include "fem/solve/static_solver.h"
#include "geometry/parts/part_mesh.h"

namespace flexmorph::fem {

/// Between two nodes that take part: 1/2 k (w_b - w_a)² of one component.
struct NodeSpring {
  int a = 0, b = 0, component = 0;
  double stiffness = 0;  ///< k [N/m]
};

/// Which displacements of a mesh are unknown, and when; what is between them besides triangles.
struct TrianglePlateSupports {
  std::vector<HeldUnknown> held = {};  ///< always
  /// Lines x = const, from the free end (largest x) to the root: of a load with clamp k nodes on
  /// line k and behind it are held. Empty: one support for all loads.
  std::vector<double> clamps = {};
  double small = 0;  ///< nodes that near to a clamp are on it [m]
  /// Triangles that do not take part (1); empty: all do.
  std::vector<signed char> left_out = {};
  std::vector<NodeSpring> springs = {};  ///< between nodes in front of all clamps
};

/// Linear static analysis of a plane-stress part of six-node triangles, for many loads at once.
///
/// Unknowns are numbered so that the Cholesky factor of the plate clamped at any of the lines is a
/// leading block of one factor, as in StaticSolver; between two lines in an order of least fill
/// (CAMD). SupernodalFactor, analysed once.
///
/// Source of the order: Amestoy, Davis, Duff (1996), SIAM J. Matrix Anal. Appl. 17, 886-905.
class TrianglePlate {
 public:
  /// @param mesh  lives longer
  /// @throws Error (input) when nothing is left.
  TrianglePlate(const PartMesh& mesh, const PlaneSection& section, TrianglePlateSupports supports);
  ~TrianglePlate();
  TrianglePlate(TrianglePlate&&) noexcept;

  const PartMesh& mesh() const;
  const PlaneSection& section() const;
  int n_unknowns() const;
  /// Place of a displacement among the unknowns, or -1.
  int row(int node, int component) const;
  bool takes_part(std::size_t triangle) const;
  /// The first clamp a node or triangle is in front of (a triangle may be bounded by the clamp):
  /// n_clamps where there is none; 0 for all without clamps.
  int first_clamp(int node) const;
  int first_clamp(std::size_t triangle) const;
  int n_clamps() const;  ///< 1 where there are no lines

  /// @throws Error (numerical) when K is not positive definite.
  void factorize();
  /// Solves in place: (n_loads x n_unknowns); of a load with clamp k what is not in front of it is
  /// ignored, and comes back 0. Clamps ascend.
  void solve(MatrixXd& loads, std::span<const int> clamps) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace flexmorph::fem
