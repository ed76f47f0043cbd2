#include "geometry/parts/size_field.h"

#include <algorithm>
#include <cstddef>

namespace flexmorph {
namespace {

/// Selects the quarter of a square that contains a point and updates the corner and the width.
/// @returns the index of the quarter
int enter_quarter(const Vec2& point, Vec2& corner, double& width) {
  width *= 0.5;
  const bool right = point.x() >= corner.x() + width, upper = point.y() >= corner.y() + width;
  corner += Vec2(right ? width : 0, upper ? width : 0);
  return (right ? 1 : 0) + (upper ? 2 : 0);
}

}  // namespace

SizeField::SizeField(const Box& box, double size)
    : box_(box), width_((box.upper - box.lower).maxCoeff()), squares_{{size}} {
  if (!(width_ > 0) || !(size > 0))
    throw Error::input("size field: the box and the element size must be positive");
}

double SizeField::at(const Vec2& point) const {
  const Vec2 inside = point.cwiseMax(box_.lower).cwiseMin(box_.upper);
  Vec2 corner = box_.lower;
  double width = width_;
  int at = 0;
  while (squares_[static_cast<std::size_t>(at)].children >= 0)
    at = squares_[static_cast<std::size_t>(at)].children + enter_quarter(inside, corner, width);
  return squares_[static_cast<std::size_t>(at)].size;
}

void SizeField::refine(const Vec2& point, double reach, double size) {
  const Vec2 inside = point.cwiseMax(box_.lower).cwiseMin(box_.upper);
  // Squares smaller than the sizes in them would have no effect, and a reach of 0 would never end.
  const double smallest = std::max(reach, 0.5 * size);
  Vec2 corner = box_.lower;
  double width = width_;
  std::size_t at = 0;
  while (width > smallest || squares_[at].children >= 0) {
    if (squares_[at].children < 0) {
      if (squares_[at].size <= size) return;
      squares_[at].children = static_cast<int>(squares_.size());
      squares_.insert(squares_.end(), 4, Square{squares_[at].size});
    }
    const int quarter = enter_quarter(inside, corner, width);
    at = static_cast<std::size_t>(squares_[at].children + quarter);
  }
  squares_[at].size = std::min(squares_[at].size, size);
}

}  // namespace flexmorph
