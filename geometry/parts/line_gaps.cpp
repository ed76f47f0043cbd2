#include "geometry/parts/line_gaps.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace flexmorph {
namespace {

constexpr double kContactDistance = 1e-9;

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

bool cross_each_other(const Segment& s, const Segment& t) {
  const Vec2 u = s.b - s.a, v = t.b - t.a;
  return cross(u, t.a - s.a) * cross(u, t.b - s.a) < 0 &&
         cross(v, s.a - t.a) * cross(v, s.b - t.a) < 0;
}

class LineGaps {
 public:
  LineGaps(std::span<const Region> regions, double limit) : regions_(regions), limit_(limit) {
    for (const Region& r : regions) {
      rings_.push_back(r.outer);
      rings_.insert(rings_.end(), r.holes.begin(), r.holes.end());
    }
  }

  void find(const Segment& line) {
    for (const std::vector<Vec2>& ring : rings_) find(line, ring);
  }
  std::vector<LengthScaleViolation> take() { return std::move(found_); }

 private:
  /// Finds runs of vertices that are equally far from the line and nearer than their neighbours.
  void find(const Segment& line, const std::vector<Vec2>& ring) {
    const size_t n = ring.size();
    const double small = kContactDistance * (line.b - line.a).norm();
    std::vector<double> far;
    for (const Vec2& p : ring) far.push_back(distance(line, p));
    const auto at = [&](size_t k) { return far[k % n]; };
    for (size_t k = 0; k < n; ++k) {
      if (!(at(k) < limit_) || at(k) < small || at(k + n - 1) - at(k) < small) continue;
      size_t last = k;
      while (last < k + n && at(last + 1) - at(k) < small && at(k) - at(last + 1) < small) ++last;
      if (at(last + 1) < at(k)) continue;
      add(line, 0.5 * (ring[k] + ring[last % n]));
    }
  }

  void add(const Segment& line, const Vec2& end) {
    LengthScaleViolation gap;
    gap.solid = false;
    gap.a = nearest_on(line, end);
    gap.b = end;
    gap.center = 0.5 * (gap.a + gap.b);
    gap.width = (gap.a - gap.b).norm();
    const bool beside =
        std::abs((line.b - line.a).normalized().dot(gap.a - end)) > 1e-9 * gap.width;
    if (!beside && !blocked({gap.a, gap.b})) found_.push_back(gap);
  }

  /// Returns true if the gap is blocked by other material or lies inside material.
  bool blocked(const Segment& way) const {
    const Vec2 middle = 0.5 * (way.a + way.b);
    if (std::any_of(regions_.begin(), regions_.end(),
                    [&](const Region& r) { return contains(r, middle); }))
      return true;
    for (const std::vector<Vec2>& ring : rings_)
      for (size_t k = 0; k < ring.size(); ++k)
        if (cross_each_other(way, {ring[k], ring[(k + 1) % ring.size()]})) return true;
    return false;
  }

  std::span<const Region> regions_;
  double limit_;
  std::vector<std::vector<Vec2>> rings_;
  std::vector<LengthScaleViolation> found_;
};

}  // namespace

std::vector<LengthScaleViolation> line_gaps(std::span<const Region> regions,
                                            std::span<const Segment> lines, double limit) {
  LineGaps gaps(regions, limit);
  for (const Segment& line : lines) gaps.find(line);
  std::vector<LengthScaleViolation> out = gaps.take();
  std::stable_sort(out.begin(), out.end(),
                   [](const LengthScaleViolation& x, const LengthScaleViolation& y) {
                     return x.width < y.width;
                   });
  return out;
}

}  // namespace flexmorph
