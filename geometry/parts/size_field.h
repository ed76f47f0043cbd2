#pragma once

#include <vector>

#include "geometry/components/component.h"

namespace flexmorph {

/// How large the triangles of a mesh may be, from place to place: a tree of squares (quadtree) over
/// a box. A size is only ever made smaller.
class SizeField {
 public:
  /// @param size  everywhere, at first [m]
  /// @throws Error (input) when the box is empty or the size is not positive.
  SizeField(const Box& box, double size);

  double at(const Vec2& point) const;  ///< [m]; of points outside that of the nearest one inside

  /// Sides of triangles around a point are no longer than `size` from now on: in the square that
  /// holds it, which is at most `reach` wide   [m].
  void refine(const Vec2& point, double reach, double size);

 private:
  struct Square {
    double size;
    int children = -1;  ///< place of the first of four
  };
  Box box_;
  double width_;
  std::vector<Square> squares_;
};

}  // namespace flexmorph
