#pragma once

#include <vector>

#include "geometry/components/component.h"

namespace flexmorph {

/// The largest allowed side length of triangles as a function of the position. It is stored in a
/// tree of squares (quadtree) over a box. Sizes can only be reduced.
class SizeField {
 public:
  /// Creates a uniform field.
  /// @param size  initial size in the whole box [m]
  /// @throws Error (input) when the box is empty or the size is not positive.
  SizeField(const Box& box, double size);

  /// Returns the size at a point [m]; for a point outside the box, the size at the nearest point
  /// inside.
  double at(const Vec2& point) const;

  /// Limits the sides of triangles around a point to `size` [m]. The limit applies in the square
  /// that contains the point. The square is at most as wide as the larger one of `reach` [m] and
  /// half of `size`.
  void refine(const Vec2& point, double reach, double size);

 private:
  struct Square {
    double size;
    int children = -1;  // index of the first of four squares; -1: none
  };
  Box box_;
  double width_;
  std::vector<Square> squares_;
};

}  // namespace flexmorph
