#include "geometry/parts/segment.h"

#include <algorithm>

namespace flexmorph {

Vec2 nearest_on(const Segment& s, const Vec2& point) {
  const Vec2 along = s.b - s.a;
  const double square = along.squaredNorm();
  const double t = square > 0 ? std::clamp(along.dot(point - s.a) / square, 0.0, 1.0) : 0.0;
  return s.a + t * along;
}

double distance(const Segment& s, const Vec2& point) {
  return (nearest_on(s, point) - point).norm();
}

std::vector<Segment> sides_of(std::span<const std::vector<Vec2>> rings) {
  std::vector<Segment> out;
  for (const std::vector<Vec2>& ring : rings)
    for (std::size_t k = 0; k < ring.size(); ++k)
      out.push_back({ring[k], ring[(k + 1) % ring.size()]});
  return out;
}

}  // namespace flexmorph
