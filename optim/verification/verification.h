#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "fem/section.h"
#include "fem/solve/static_solver.h"
#include "optim/verification/loads.h"

/// Finite-element verification of an exported outline: its compliance and stresses under its loads.
namespace flexmorph::verification {

/// Settings of the verification of an outline.
struct VerificationSettings {
  double tolerance = 0.005;  ///< Target for the estimated relative error of the compliance [-].
  double size = 0;           ///< Largest size of the first triangles [m].

  /// Distance from locations, clamps and the held edge within which stresses do not count [m],
  /// because there they depend on how loads and supports are applied. Half the side of the squares
  /// that stand for points, see point_location().
  double reach = 0;
  int max_triangles = 400000;  ///< Number of triangles above which a mesh is not refined.
  int max_meshes = 9;          ///< Largest number of meshes.

  /// Cancellation callback, called after each mesh; false stops. Empty: the verification continues.
  std::function<bool()> keep_running = {};
};

/// A load on the last mesh in a form that another program can read.
struct MeshLoad {
  std::string name;                     ///< Name of the load.
  int load = 0;                         ///< Index in Loads::loads.
  double compliance = 0;                ///< Compliance of the load [J].
  std::vector<fem::HeldUnknown> held;   ///< Held displacements, including those behind the clamp.
  std::vector<double> prescribed;       ///< Value of each held displacement [m].
  std::vector<fem::NodalForce> forces;  ///< Consistent nodal forces [N].
};

/// The largest von Mises stress of one load, away from locations, its clamp and a held edge.
struct LargestStress {
  double value = 0;  ///< Von Mises stress [Pa].
  Vec2 at{0, 0};     ///< Position of the node [m].
};

/// The result of the verification of an outline.
struct OutlineVerification {
  /// Weighted sum or largest value of the compliances of the loads, see Loads::worst [J]; infinite
  /// if a load acts on unsupported material.
  double compliance = 0;
  double error = 0;        ///< Estimated relative error [-]; the compliance is too small by it.
  bool converged = false;  ///< True if the error is at most the tolerance.

  std::vector<double> compliances;              ///< Compliance of each load [J].
  std::vector<double> largest_displacements;    ///< Largest nodal displacement of each load [m].
  std::vector<LargestStress> largest_stresses;  ///< Largest stress of each load.
  std::string unsupported_load;  ///< Name of a load that acts on unsupported material, or empty.
  double area = 0;               ///< Area of all regions [m²].

  /// Largest von Mises stress of all loads, averaged at nodes, away from locations [Pa].
  double largest_stress = 0;
  Vec2 largest_at{0, 0};  ///< Position of the largest stress [m].
  int largest_load = -1;  ///< Index in Loads::loads of the load with the largest stress, or -1.
  int n_connected_regions = 0;  ///< Number of connected regions of the mesh.
  int n_omitted_regions = 0;    ///< Number of unsupported connected regions, which are left out.
  int meshes = 0;               ///< Number of meshes that were solved.
  PartMesh mesh;                ///< Last mesh.
  std::vector<signed char> omitted_triangles;  ///< Value 1 for triangles left out (n_triangles).

  /// Stress averaged at nodes under the load with the largest compliance (3 x n_nodes): σ₁₁, σ₂₂,
  /// σ₁₂ [Pa].
  MatrixXd stress;
  /// Nodal displacements under the load with the largest compliance (2 n_nodes) [m]; zero in
  /// regions that are left out.
  VectorXd displacement;
  LargestStress shown_stress;  ///< Largest stress under the load with the largest compliance.
  std::string shown_load;      ///< Name of the load with the largest compliance.

  /// All loads on the last mesh, the one with the largest compliance first. Loads with clamps: only
  /// the one with the largest compliance. Empty if springs hold an edge.
  std::vector<MeshLoad> mesh_loads;
  double seconds = 0;  ///< CPU time [s].
};

/// Computes compliance, stress and area of a part under its loads. The mesh has six-node triangles
/// that follow the outline. It is refined where the estimated error is large, until the estimated
/// error of the compliance is small.
///
/// The error estimate is the larger one of two: that of recovered stresses (fem::RecoveredStress),
/// and the change by the last refinement, C - C_h ≈ (C_h - C_2h) / (n_h / n_2h - 1), where n is the
/// number of triangles. The second one assumes that the error halves when n doubles, as at a
/// corner; for smooth fields it falls faster.
///
/// A connected region that is not supported is left out together with its inertia. Without clamps,
/// a region is supported if the supports prevent all its rigid motions; with clamps, if it does not
/// lie entirely in front of any of the clamps. If less than half of the material that a force is
/// distributed over is supported, the compliance is infinite.
///
/// @param regions  outlines as they are exported
/// @throws Error (input) if there are no loads; Error (numerical) if the regions have no area or
///         the static analysis fails.
OutlineVerification verify_outline(std::span<const Region> regions,
                                   const fem::PlaneSection& section, const Loads& loads,
                                   const VerificationSettings& settings);

}  // namespace flexmorph::verification
