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

/// Triangles with six nodes and straight sides that fill a part: no side crosses its outline.
struct PartMesh {
  std::vector<Vec2> points;  ///< nodes: corners of triangles first, then middles of sides [m]
  int n_corners = 0;
  /// Corners counterclockwise, then the middles of sides 0-1, 1-2, 2-0.
  std::vector<std::array<int, 6>> triangles;
  /// Which piece each triangle belongs to, from 0: pieces share no side. (Two parts of one region
  /// that hang together in a point are two pieces with a common node.)
  std::vector<int> piece;
  int n_pieces = 0;

  const Vec2& point(int node) const { return points[static_cast<std::size_t>(node)]; }
  std::array<Vec2, 3> corners(std::size_t triangle) const;
  double area() const;  ///< [m^2]
};

/// Delaunay refinement of a part: constrained triangulation of its outline, points put in until no
/// triangle is larger than wanted or has an angle below 20.7 degrees, but where the outline itself
/// has sharper ones. Narrow places get small triangles by themselves: no point lies within the
/// circle over a side of the outline. The same part gives the same mesh, bit for bit.
///
/// Regions are meshed one by one: pieces that touch in a point have no common node.
///
/// Source: Shewchuk (2002), Comput. Geom. 22, 21-74; CGAL's Mesh_2 does it.
class PartMesher {
 public:
  /// @param regions  as unite() returns them; vertices move by no more than 1e-9 of the part's size
  /// @param lines    no triangle crosses the part of them that is inside, and their ends are nodes
  ///                 where they lie on the outline. Lines that are neither horizontal nor vertical
  ///                 must lie along the outline.
  /// @throws Error (numerical) when there is no area.
  PartMesher(std::span<const Region> regions, std::span<const Segment> lines);
  ~PartMesher();
  PartMesher(PartMesher&&) noexcept;

  /// Puts points in until all triangles are as small as said at their middles and corners. Points
  /// stay.
  void refine(const SizeField& size);
  PartMesh mesh() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Corners of the outline where material reaches around by more than `angle` [rad].
std::vector<Vec2> reentrant_corners(std::span<const Region> regions, double angle);

}  // namespace flexmorph
