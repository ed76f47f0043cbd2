#include "geometry/parts/conforming_rings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace flexmorph {
namespace {

/// Moves a vertex that is nearly on a line, or on one of its ends, onto it.
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

/// Adds the points in which a line meets the side a b strictly between the ends of the side. For a
/// line along an axis the constant coordinate is exact.
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

/// Replaces all numbers of a sequence in which neighbours differ by less than `small` by one
/// number.
class Unifier {
 public:
  Unifier(std::vector<double> values, double small) : values_(std::move(values)) {
    std::sort(values_.begin(), values_.end());
    values_.erase(std::unique(values_.begin(), values_.end()), values_.end());
    for (std::size_t k = 0; k < values_.size(); ++k)
      common_.push_back(k > 0 && values_[k] - values_[k - 1] <= small ? common_.back()
                                                                      : values_[k]);
  }
  double operator()(double value) const {
    const auto at = std::lower_bound(values_.begin(), values_.end(), value);
    return common_[static_cast<std::size_t>(at - values_.begin())];
  }

 private:
  std::vector<double> values_, common_;
};

}  // namespace

std::vector<Segment> conforming_lines(std::span<const Segment> lines, double small) {
  std::array<std::vector<double>, 2> ends;
  for (const Segment& s : lines)
    for (std::size_t axis = 0; axis < 2; ++axis)
      for (const Vec2& p : {s.a, s.b}) ends[axis].push_back(p[static_cast<Eigen::Index>(axis)]);
  const Unifier x(std::move(ends[0]), small), y(std::move(ends[1]), small);
  // Horizontal and vertical lines: constant coordinate, start and end.
  struct Line {
    double at, from, to;
  };
  std::array<std::vector<Line>, 2> along;
  std::vector<Segment> out;
  for (const Segment& s : lines) {
    if (s.a.x() != s.b.x() && s.a.y() != s.b.y()) out.push_back(s);
    const Vec2 a(x(s.a.x()), y(s.a.y())), b(x(s.b.x()), y(s.b.y()));
    for (int axis = 0; axis < 2; ++axis)
      if (a[1 - axis] == b[1 - axis] && a[axis] != b[axis])
        along[static_cast<std::size_t>(axis)].push_back(
            {a[1 - axis], std::min(a[axis], b[axis]), std::max(a[axis], b[axis])});
    if (a == b) out.push_back({a, b});
  }
  std::vector<double> cuts;
  for (int axis = 0; axis < 2; ++axis)
    for (const Line& line : along[static_cast<std::size_t>(axis)]) {
      cuts = {line.from, line.to};
      for (const Line& other : along[static_cast<std::size_t>(1 - axis)])
        if (other.at > line.from && other.at < line.to && line.at >= other.from &&
            line.at <= other.to)
          cuts.push_back(other.at);
      std::sort(cuts.begin(), cuts.end());
      for (std::size_t k = 1; k < cuts.size(); ++k) {
        if (cuts[k - 1] == cuts[k]) continue;
        Segment s{Vec2::Constant(line.at), Vec2::Constant(line.at)};
        s.a[axis] = cuts[k - 1];
        s.b[axis] = cuts[k];
        out.push_back(s);
      }
    }
  return out;
}

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
