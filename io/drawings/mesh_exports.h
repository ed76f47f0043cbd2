#pragma once

#include <span>
#include <string>
#include <vector>

#include "geometry/parts/part_mesh.h"

/// Export of meshes with loads and supports to other programs.
namespace flexmorph::io {

/// A prescribed displacement of a node in x (0) or y (1).
struct HeldNode {
  int node = 0, component = 0;  ///< Index of the node, and direction of the displacement.
  double value = 0;             ///< Displacement [m].
};
/// A force on a node.
struct NodeForce {
  int node = 0;      ///< Index of the node.
  Vec2 force{0, 0};  ///< Force [N].
};
/// A load case: the supports and forces of one analysis.
struct MeshLoad {
  std::string name;               ///< Name of the load.
  std::vector<HeldNode> held;     ///< Prescribed displacements.
  std::vector<NodeForce> forces;  ///< Consistent nodal forces.
};

/// A plate in plane stress as input for a finite-element program, in metres, newtons and pascals.
struct PlateModel {
  const PartMesh& mesh;  ///< Mesh of the plate; it must exist longer than the model.

  /// Value 1 for triangles that no support holds; empty: none.
  std::span<const signed char> left_out;
  /// Thickness [m], Young's modulus [Pa] and Poisson's ratio [-].
  double thickness = 1, youngs_modulus = 1, poisson_ratio = 0.3;
  std::vector<MeshLoad> loads;  ///< Load cases, each of which is a step of the analysis.
};

/// Writes an input file of Abaqus or CalculiX: elements CPS6, and one step for each load with its
/// supports, consistent nodal loads, and output of displacements and stresses. A plate that is
/// thicker than its triangles are wide is written as a thin slice with a proportional fraction of
/// the forces (see slice_of() in the .cpp file); displacements and stresses are the same. Triangles
/// whose nodes are all held in every load are omitted.
/// @throws Error as write_file().
void write_inp(const std::string& path, const PlateModel& model);

/// Writes a Gmsh mesh (version 2.2, ASCII) of six-node triangles. Each connected region is a
/// physical surface "piece_1", "piece_2", ...
void write_msh(const std::string& path, const PartMesh& mesh);

/// Writes a Gmsh geometry: a line for each side of the outline, a plane surface for each region.
/// @param size  size of the triangles that Gmsh creates [m]
void write_geo(const std::string& path, std::span<const Region> regions, double size);

}  // namespace flexmorph::io
