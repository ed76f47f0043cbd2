#pragma once

#include <map>
#include <span>
#include <utility>
#include <vector>

#include "geometry/parts/picture.h"

namespace flexmorph {

/// A vertex of outlines, and the sides that meet there.
struct OutlineCorner {
  Vec2 before{0, 0}, after{0, 0};  ///< directions of the sides that end and begin here
  int visits = 0;                  ///< how many times outlines pass through the vertex
  size_t number = 0;               ///< among the vertices in the order of their coordinates
  bool border_before = false, border_after = false;  ///< are these sides on the domain's border?
  bool border = false;                               ///< is the vertex on the domain's border?
};

/// The vertices and sides of outlines in the order of their coordinates, wherever rings begin.
class OutlineSides {
 public:
  /// @param regions  live longer
  /// @param domain   what the regions are clipped to
  OutlineSides(std::span<const Region> regions, const Region& domain);

  /// Returns the vertices.
  const std::vector<Vec2>& points() const { return points_; }
  /// Returns the sides as pairs of vertices; they keep the material on their left.
  const std::vector<std::pair<size_t, size_t>>& sides() const { return sides_; }
  /// Tells whether the k-th side is on the border of the domain.
  bool on_border(size_t k) const { return borders_[k]; }
  /// Returns what is known of a vertex; null where there is none.
  const OutlineCorner* corner(const Vec2& p) const;
  /// Returns all vertices by their coordinates.
  const std::map<std::pair<double, double>, OutlineCorner>& corners() const { return corners_; }
  /// Tells whether a point is in one of the regions.
  bool in_material(const Vec2& p) const;
  /// Tells whether a point is in the domain, by counting crossings.
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
  std::vector<std::vector<Vec2>> domain_;  // rings
  double size_ = 0;
  std::vector<Vec2> points_;
  std::vector<std::pair<size_t, size_t>> sides_;
  std::vector<bool> borders_;  // of the sides
  std::map<std::pair<double, double>, OutlineCorner> corners_;
  std::vector<Side> ends_;
};

}  // namespace flexmorph
