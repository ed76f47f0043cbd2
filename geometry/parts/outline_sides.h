#pragma once

#include <map>
#include <span>
#include <utility>
#include <vector>

#include "geometry/parts/picture.h"

namespace flexmorph {

/// A vertex of outlines, and the sides that meet there.
struct OutlineCorner {
  Vec2 before{0, 0}, after{0, 0};  ///< Directions of the sides that end and begin at the vertex.
  int visits = 0;                  ///< Number of times that outlines pass through the vertex.
  size_t number = 0;               ///< Index of the vertex in the order of coordinates.

  /// True if the side that ends (begins) at the vertex is on the border of the domain.
  bool border_before = false, border_after = false;
  bool border = false;  ///< True if the vertex is on the border of the domain.
};

/// The vertices and sides of outlines, sorted by their coordinates. The order does not depend on
/// the first vertices of rings.
class OutlineSides {
 public:
  /// Collects the vertices and sides of regions.
  /// @param regions  regions; they must exist longer than this object
  /// @param domain   domain to which the regions are clipped
  OutlineSides(std::span<const Region> regions, const Region& domain);

  /// Returns the vertices [m].
  const std::vector<Vec2>& points() const { return points_; }
  /// Returns the sides as pairs of vertex indices; the material is on the left of each side.
  const std::vector<std::pair<size_t, size_t>>& sides() const { return sides_; }
  /// Returns true if the k-th side is on the border of the domain.
  bool on_border(size_t k) const { return borders_[k]; }
  /// Returns the data of a vertex, or null if there is no vertex at the point.
  const OutlineCorner* corner(const Vec2& p) const;
  /// Returns all vertices, sorted by their coordinates.
  const std::map<std::pair<double, double>, OutlineCorner>& corners() const { return corners_; }
  /// Returns true if a point is in one of the regions.
  bool in_material(const Vec2& p) const;
  /// Returns true if a point is in the domain (even-odd rule).
  bool within(const Vec2& p) const;

 private:
  struct Side {
    const OutlineCorner *from, *to;
    bool border;
  };

  void add(const std::vector<Vec2>& ring);
  void number();
  bool on_border(const Vec2& a, const Vec2& b) const;
  bool near_line(const Vec2& p, const Vec2& a, const Vec2& b) const;

  std::span<const Region> regions_;
  std::vector<std::vector<Vec2>> domain_;  // rings of the domain
  double size_ = 0;
  std::vector<Vec2> points_;
  std::vector<std::pair<size_t, size_t>> sides_;
  std::vector<bool> borders_;  // true for sides on the border
  std::map<std::pair<double, double>, OutlineCorner> corners_;
  std::vector<Side> ends_;
};

}  // namespace flexmorph
