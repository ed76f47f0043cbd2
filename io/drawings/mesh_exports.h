#pragma once

#include <span>
#include <string>
#include <vector>

#include "geometry/parts/part_mesh.h"

/// Meshes with loads and supports for other programs.
namespace flexmorph::io {

/// A displacement that is given: of a node in x (0) or y (1).
struct HeldNode {
  int node = 0, component = 0;
  double value = 0;  ///< [m]
};
struct NodeForce {
  int node = 0;
  Vec2 force{0, 0};  ///< [N]
};
struct MeshLoad {
  std::string name;
  std::vector<HeldNode> held;
  std::vector<NodeForce> forces;
};

/// A plate of plane stress as a finite-element program takes it. Metres, newtons, pascals.
struct PlateModel {
  const PartMesh& mesh;
  std::span<const signed char> left_out;  ///< triangles that nothing holds (1); empty: none
  double thickness = 1, youngs_modulus = 1, poisson_ratio = 0.3;
  std::vector<MeshLoad> loads;
};

/// Abaqus or CalculiX input: elements CPS6, a step per load with its supports and consistent nodal
/// loads, displacements and stresses asked for. Plates thicker than their triangles are wide are
/// written as a thin slice with its part of the forces, see the .cpp: same displacements and
/// stresses. Triangles all of whose nodes are held in every load
/// are left away.
/// @throws Error as write_file().
void write_inp(const std::string& path, const PlateModel& model);

/// Gmsh mesh, version 2.2 ASCII: six-node triangles; one physical surface per piece, "piece_1" ...
void write_msh(const std::string& path, const PartMesh& mesh);

/// Gmsh geometry: the outline, every side a line, a plane surface per region; `size` is that of
/// Gmsh's own triangles [m].
void write_geo(const std::string& path, std::span<const Region> regions, double size);

}  // namespace flexmorph::io
