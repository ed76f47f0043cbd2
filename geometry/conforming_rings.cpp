#include "geometry/conforming_rings.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace flexmorph {
namespace {

/// Puts a vertex that is all but on a line, or on one of its ends, there.
Vec2 snapped(Vec2 p, std::span<const Segment> lines, double small) {
  for (const Segment& s : lines) {
    if (distance(s, p) > small) continue;
    if (s.a.x() == s.b.x()) p.x() = s.a.x();
    if (s.a.y() == s.b.y()) p.y() = s.a.y();
    for (const Vec2& end : {s.a, s.b})
      if ((p - end).norm() <= small) p = end;
  }
  return p;
}

/// Where a straight line meets the side a b strictly between its ends, and not at once with one of
/// them; with the exact coordinate of a line along an axis.
void add_crossing(const Segment& s, const Vec2& a, const Vec2& b, double small,
                  std::vector<std::pair<double, Vec2>>& out) {
  const Vec2 side = b - a;
  const double length = side.norm();
  const auto add = [&](const Vec2& p) {
    const double t = (p - a).dot(side) / length;
    if (t > small && t < length - small && distance(Segment{a, b}, p) <= small)
      out.emplace_back(t, p);
  };
  add(s.a);
  add(s.b);
  for (int axis = 0; axis < 2; ++axis) {
    if (s.a[axis] != s.b[axis] || (a[axis] < s.a[axis]) == (b[axis] < s.a[axis])) continue;
    const double t = (s.a[axis] - a[axis]) / side[axis];
    Vec2 p = a + t * side;
    p[axis] = s.a[axis];
    if (distance(s, p) <= small) add(p);
  }
}

std::vector<Vec2> ring_with_points(const std::vector<Vec2>& ring, std::span<const Segment> lines,
                                   double small) {
  std::vector<Vec2> moved;
  for (const Vec2& p : ring) {
    const Vec2 at = snapped(p, lines, small);
    if (moved.empty() || (moved.back() - at).norm() > small) moved.push_back(at);
  }
  while (moved.size() > 1 && (moved.front() - moved.back()).norm() <= small) moved.pop_back();
  std::vector<Vec2> out;
  std::vector<std::pair<double, Vec2>> crossings;
  for (std::size_t k = 0; k < moved.size(); ++k) {
    const Vec2 &a = moved[k], &b = moved[(k + 1) % moved.size()];
    out.push_back(a);
    crossings.clear();
    for (const Segment& s : lines) add_crossing(s, a, b, small, crossings);
    std::sort(crossings.begin(), crossings.end(),
              [](const auto& x, const auto& y) { return x.first < y.first; });
    for (const auto& [t, p] : crossings)
      if ((out.back() - p).norm() > small) out.push_back(p);
  }
  return out;
}

}  // namespace

double smallest_distance(std::span<const Region> regions) {
  constexpr double kPart = 1e-9;
  Vec2 lower = Vec2::Constant(INFINITY), upper = -lower;
  for (const Region& r : regions)
    for (const Vec2& p : r.outer) {
      lower = lower.cwiseMin(p);
      upper = upper.cwiseMax(p);
    }
  return regions.empty() ? 0 : kPart * (upper - lower).norm();
}

Region with_points_of(const Region& region, std::span<const Segment> lines, double small) {
  Region out{ring_with_points(region.outer, lines, small), {}};
  for (const auto& hole : region.holes) {
    auto ring = ring_with_points(hole, lines, small);
    if (ring.size() >= 3) out.holes.push_back(std::move(ring));
  }
  return out;
}

}  // namespace flexmorph
