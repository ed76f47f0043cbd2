#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "geometry/components/outline.h"
#include "geometry/parts/segment.h"
#include "geometry/parts/size_field.h"

/// Meshes that follow the outline of a part.
namespace flexmorph {

/// A mesh of six-node triangles with straight sides that fills a part. No side crosses the outline.
struct PartMesh {
  /// Nodes: first the corners of triangles, then the middles of sides [m].
  std::vector<Vec2> points;
  int n_corners = 0;  ///< Number of nodes that are corners of triangles.

  /// Nodes of each triangle: corners counterclockwise, then the middles of the sides 0-1, 1-2, 2-0.
  std::vector<std::array<int, 6>> triangles;
  /// Index of the connected region of each triangle, from 0. Triangles of two connected regions
  /// share no side. Where two parts of one region share only a point, they are two connected
  /// regions with a common node.
  std::vector<int> piece;
  int n_connected_regions = 0;  ///< Number of connected regions.

  /// Returns the position of a node [m].
  const Vec2& point(int node) const { return points[static_cast<std::size_t>(node)]; }
  /// Returns the corners of a triangle [m].
  std::array<Vec2, 3> corners(std::size_t triangle) const;
  /// Returns the area of the mesh [m^2].
  double area() const;
};

/// A mesher for parts by Delaunay refinement. It starts from the constrained triangulation of the
/// outline and inserts points until no triangle is larger than prescribed or has an angle below
/// 20.7 degrees. Smaller angles remain only where the outline has sharper corners. Narrow parts get
/// small triangles automatically, because no point lies within the diametral circle of a side of
/// the outline. The mesh of a part is reproducible bit for bit.
///
/// Regions are meshed separately: regions that touch in a point have no common node.
///
/// Source: Shewchuk (2002), Comput. Geom. 22, 21-74; implementation: Mesh_2 of CGAL.
class PartMesher {
 public:
  /// Creates the constrained triangulation of the regions.
  /// @param regions  regions as unite() returns them; vertices are moved by at most 1e-9 of the
  ///         size of the part
  /// @param lines    no triangle crosses the part of a line that is inside; the ends of lines are
  ///         nodes where they lie on the outline. Lines that are neither horizontal nor vertical
  ///         must lie along the outline.
  /// @throws Error (numerical) when the regions have no area.
  PartMesher(std::span<const Region> regions, std::span<const Segment> lines);
  ~PartMesher();
  /// Takes the mesh of another mesher.
  PartMesher(PartMesher&&) noexcept;

  /// Inserts points until the sides of all triangles are as small as prescribed at their centroids
  /// and corners. Existing points are kept.
  void refine(const SizeField& size);
  /// Returns the current mesh.
  PartMesh mesh() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Returns the corners of the outline at which the angle inside the material is larger than `angle`
/// [rad].
std::vector<Vec2> reentrant_corners(std::span<const Region> regions, double angle);

}  // namespace flexmorph
