#include "geometry/disc.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace flexmorph {

Disc disc_like(const std::vector<Vec2>& ring) {
  const Vec2& origin = ring.front();  // near the polygon, so that products stay small
  double twice_area = 0;
  Vec2 moment = Vec2::Zero();
  for (size_t k = 0; k < ring.size(); ++k) {
    const Vec2 a = ring[k] - origin, b = ring[(k + 1) % ring.size()] - origin;
    const double cross = a.x() * b.y() - a.y() * b.x();
    twice_area += cross;
    moment += cross * (a + b);
  }
  return {origin + moment / (3 * twice_area),
          std::sqrt(0.5 * std::abs(twice_area) / std::numbers::pi)};
}

bool matches(const std::vector<Vec2>& ring, const Disc& disc, double tolerance) {
  const Disc like = disc_like(ring);
  return (like.center - disc.center).norm() <= tolerance &&
         std::abs(like.radius - disc.radius) <= tolerance &&
         std::all_of(ring.begin(), ring.end(), [&](const Vec2& p) {
           return std::abs((p - like.center).norm() - like.radius) <= tolerance;
         });
}

}  // namespace flexmorph
