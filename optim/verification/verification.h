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

struct Settings {
  double tolerance = 0.005;  ///< of the compliance, by the estimate of the verification
  double size = 0;           ///< of the first triangles, at most [m]
  /// What points stand for reaches so far; stresses within that distance of locations do not count,
  /// as they belong to the way loads are put on [m].
  double reach = 0;
  int max_triangles = 400000;  ///< no mesh is refined beyond it
  int max_meshes = 9;
  std::function<bool()> keep_running = {};  ///< asked after each mesh; none: yes
};

/// A load on the last mesh, as another program may read it.
struct MeshLoad {
  std::string name;
  int load = 0;  ///< index in Loads::loads
  double compliance = 0;
  std::vector<fem::HeldUnknown> held;   ///< with those behind the clamp
  std::vector<double> prescribed;       ///< displacement of each of them [m]
  std::vector<fem::NodalForce> forces;  ///< consistent [N]
};

/// The largest von Mises stress of one load, away from locations, its clamp and a held edge.
struct LargestStress {
  double value = 0;  ///< [Pa]
  Vec2 at{0, 0};     ///< [m]
};

struct OutlineVerification {
  /// Weighted sum of the loads, or the largest; infinite where a load acts on nothing that is held.
  double compliance = 0;   ///< [J]
  double error = 0;        ///< its estimated error, relative; the compliance is too small by that
  bool converged = false;  ///< Is the error below the tolerance?
  std::vector<double> compliances;              ///< of each load [J]
  std::vector<double> largest_displacements;    ///< of any node, of each load [m]
  std::vector<LargestStress> largest_stresses;  ///< of each load
  std::string unsupported_load;  ///< name of a load that acts on nothing that is held; empty: none
  double area = 0;               ///< of all pieces [m²]
  double largest_stress =
      0;                  ///< von Mises, averaged at nodes, of all loads, away from locations [Pa]
  Vec2 largest_at{0, 0};  ///< where [m]
  int largest_load = -1;
  int n_pieces = 0;          ///< connected components of the mesh
  int n_omitted_pieces = 0;  ///< those that nothing holds, which take no part
  int meshes = 0;            ///< that were solved
  PartMesh mesh;             ///< the last one
  std::vector<signed char> omitted_triangles;
  MatrixXd stress;  ///< averaged at nodes, of the worst load (3 x n_nodes): σ₁₁, σ₂₂, σ₁₂ [Pa]
  VectorXd displacement;       ///< of nodes under that load (2 n_nodes) [m]; of what is left out: 0
  LargestStress shown_stress;  ///< of that load
  std::string shown_load;      ///< its name
  /// All loads; where they have clamps the worst one; none where springs hold an edge.
  std::vector<MeshLoad> mesh_loads;
  double seconds = 0;  ///< CPU
};

/// Compliance, stress and area of a part under its loads: six-node triangles that follow the
/// outline, refined where the estimated error is, until that of the compliance is small.
///
/// The estimate is the larger one of recovered stresses (fem::RecoveredStress) and of what the last
/// refinement changed: C - C_h ≈ (C_h - C_2h) / (n_h / n_2h - 1) of n triangles, as at a corner
/// that halves its error with every doubling; smooth fields do better.
///
/// A piece that supports (or, of loads with a clamp, any of the clamps it sticks out of) do not
/// keep from moving is left out, with its inertia. A force of which less than half of the material
/// it is spread over is held makes the compliance infinite.
///
/// @param regions  as they are exported
/// @throws Error (input) for no loads; Error (numerical) when the regions have no area or the
///         statics fail.
OutlineVerification verify_outline(std::span<const Region> regions,
                                   const fem::PlaneSection& section, const Loads& loads,
                                   const Settings& settings);

}  // namespace flexmorph::verification
