#include <algorithm>
#include <cmath>

#include "cases/scene/read.h"
#include "geometry/components/outline.h"

namespace flexmorph::cases {

std::vector<Vec2> read_polygon(const io::Table& t, const io::Key& key) {
  const std::vector<double> flat = t.numbers(key);
  if (flat.size() < 6 || flat.size() % 2 != 0)
    t.fail(key, "a polygon has three or more corners: x0, y0, x1, y1, x2, y2, ... [m]");
  constexpr double kMaxCoordinate = 1e30;  // [m]; far beyond any plate, and products stay finite
  for (const double x : flat)
    if (std::abs(x) > kMaxCoordinate)
      t.fail(key, "the coordinates of a polygon are at most 1e30 m");
  std::vector<Vec2> ring;
  for (size_t k = 0; k < flat.size(); k += 2) ring.emplace_back(flat[k], flat[k + 1]);
  const Box box = bounds_of(ring);
  if ((box.upper - box.lower).minCoeff() <= 0) t.fail(key, "the area of a polygon is not zero");
  try {
    unite(std::vector<std::vector<Vec2>>{ring}, box);
  } catch (const Error&) {
    t.fail(key, "a polygon does not cross itself");
  }
  if (area({ring, {}}) < 0) std::reverse(ring.begin(), ring.end());
  return ring;
}

}  // namespace flexmorph::cases
