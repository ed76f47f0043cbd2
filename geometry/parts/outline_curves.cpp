#include "geometry/parts/outline_curves.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "geometry/parts/biarcs.h"
#include "geometry/parts/ring_circles.h"

namespace flexmorph {
namespace {

using Ring = std::vector<Vec2>;

constexpr double kPi = std::numbers::pi;
/// Distance below which points are merged: CAD kernels treat 1e-7 mm as zero [m].
constexpr double kSameDistance = 1e-9;
/// Distance below which a circle passes through a point [m].
constexpr double kThrough = 1e-10;
/// Angles below this value are round-off [rad].
constexpr double kRoundOff = 1e-9;

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Returns the angle from one direction to another [rad].
double angle_between(const Vec2& a, const Vec2& b) { return std::atan2(cross(a, b), a.dot(b)); }

/// Returns twice the area between a curve and the origin, positive counterclockwise.
double twice_area(const OutlineCurve& c) {
  return cross(c.from, c.to) + c.radius * c.radius * (c.sweep - std::sin(c.sweep));
}

double area(const CurveRing& ring) {
  double twice = 0;
  for (const OutlineCurve& c : ring) twice += twice_area(c);
  return 0.5 * twice;
}

std::optional<Vec2> nearest(const Vec2& to, const Vec2& a, const Vec2& b, double reach) {
  const Vec2& out = (a - to).norm() <= (b - to).norm() ? a : b;
  if (!((out - to).norm() <= reach)) return {};
  return out;
}

/// Returns an arc whose circle passes through its ends within a nanometre, as CAD kernels require.
/// The round-off of large circles can be larger.
OutlineCurve through_its_ends(const OutlineCurve& arc) {
  const double from = (arc.from - arc.center).norm(), to = (arc.to - arc.center).norm();
  const bool through = std::max(std::abs(from - arc.radius), std::abs(to - arc.radius)) < kThrough;
  return through ? arc : arc_between(arc.from, arc.to, arc.sweep);
}

/// Returns the intersection of a line through `p` with a circle near `p`.
std::optional<Vec2> met_by_line(const Disc& circle, const Vec2& p, const Vec2& along,
                                double reach) {
  const Vec2 unit = along.normalized(), to = circle.center - p;
  const double middle = to.dot(unit), off = cross(unit, to);
  const double square = circle.radius * circle.radius - off * off;
  if (!(square >= 0)) return {};
  const double half = std::sqrt(square);
  return nearest(p, p + (middle - half) * unit, p + (middle + half) * unit, reach);
}

/// Returns the intersection of two circles near a point.
std::optional<Vec2> met_by_circle(const Disc& a, const Disc& b, const Vec2& p, double reach) {
  const Vec2 to = b.center - a.center;
  const double d = to.norm();
  if (!(d > 0)) return {};
  const double along = (d * d + a.radius * a.radius - b.radius * b.radius) / (2 * d);
  const double square = a.radius * a.radius - along * along;
  if (!(square >= 0)) return {};
  const Vec2 unit = to / d, across(-unit.y(), unit.x());
  const Vec2 foot = a.center + along * unit;
  return nearest(p, foot - std::sqrt(square) * across, foot + std::sqrt(square) * across, reach);
}

/// Computes the curves of one ring of a polygon.
class RingCurves {
 public:
  RingCurves(Ring ring, std::span<const Disc> circles, double tolerance)
      : ring_(std::move(ring)),
        circles_(circles),
        tolerance_(tolerance),
        circle_(circles_of_sides(ring_, circles, tolerance)) {}

  CurveRing curves() const {
    std::vector<std::size_t> breaks;
    for (std::size_t k = 0; k < ring_.size(); ++k)
      if (is_break(k)) breaks.push_back(k);
    if (breaks.empty()) return closed();
    Ring points = ring_;
    for (const std::size_t k : breaks) points[k] = junction(k);
    CurveRing out;
    for (std::size_t b = 0; b < breaks.size(); ++b) {
      const std::size_t from = breaks[b];
      std::size_t to = breaks[(b + 1) % breaks.size()];
      if (to <= from) to += ring_.size();
      Ring chain;
      for (std::size_t k = from; k <= to; ++k) chain.push_back(points[k % points.size()]);
      if (circle_[from] >= 0)
        add_arc(circles_[static_cast<std::size_t>(circle_[from])], chain, out);
      else
        add_chain(chain, false, out);
    }
    return out;
  }

 private:
  std::size_t n() const { return ring_.size(); }
  const Vec2& vertex(std::size_t k) const { return ring_[k % n()]; }
  Vec2 side(std::size_t k) const { return vertex(k + 1) - vertex(k); }

  /// Returns true if a new curve begins at a vertex: on another circle, in another sense of
  /// rotation, or after a corner.
  bool is_break(std::size_t k) const {
    const std::size_t before = (k + n() - 1) % n();
    if (circle_[before] != circle_[k]) return true;
    if (circle_[k] >= 0) {
      const Vec2 out = vertex(k) - circles_[static_cast<std::size_t>(circle_[k])].center;
      return cross(out, side(before)) * cross(out, side(k)) <= 0;
    }
    // If sides of the length l are within t of a curve of constant curvature, the direction changes
    // by at most 8 t / l from one side to the next.
    constexpr double kSurely = 0.8, kVaries = 1.5;
    const double turn = std::abs(angle_between(side(before), side(k)));
    const double longer = std::max(side(before).norm(), side(k).norm());
    return turn > std::min(kSurely, kVaries * 8 * (0.5 * tolerance_) / longer);
  }

  /// Returns the curves of a ring without breaks.
  CurveRing closed() const {
    if (circle_[0] >= 0) {
      const Disc& c = circles_[static_cast<std::size_t>(circle_[0])];
      OutlineCurve whole = full_circle(c.center, c.radius);
      if (cross(vertex(0) - c.center, side(0)) < 0) whole.sweep = -whole.sweep;
      return {whole};
    }
    Ring chain = ring_;
    chain.push_back(ring_[0]);
    CurveRing out;
    add_chain(chain, true, out);
    return out;
  }

  /// Returns the position to which a vertex between two curves is moved, such that circles pass
  /// through the ends of their arcs.
  Vec2 junction(std::size_t k) const {
    const std::size_t before = (k + n() - 1) % n();
    const int a = circle_[before], b = circle_[k];
    const Vec2& p = vertex(k);
    if (a == b) return p;
    const double reach = 4 * tolerance_;
    if (a >= 0 && b >= 0) {
      const Disc &first = circles_[static_cast<std::size_t>(a)],
                 &second = circles_[static_cast<std::size_t>(b)];
      if (lies_on(first, p) && lies_on(second, p)) return p;
      return met_by_circle(first, second, p, reach).value_or(p);
    }
    const Disc& circle = circles_[static_cast<std::size_t>(std::max(a, b))];
    if (lies_on(circle, p)) return p;
    const Vec2 out = p - circle.center;
    return met_by_line(circle, p, side(a < 0 ? before : k), reach)
        .value_or(circle.center + circle.radius * out.normalized());
  }

  /// Appends the arc through its chords. Ends that are not on the circle are connected by lines.
  static void add_arc(const Disc& circle, const Ring& chain, CurveRing& out) {
    std::size_t first = 0, last = chain.size() - 1;
    if (!lies_on(circle, chain[first])) {
      out.push_back(line_between(chain[first], chain[first + 1]));
      ++first;
    }
    const bool tail = first < last && !lies_on(circle, chain[last]);
    if (tail) --last;
    OutlineCurve arc{chain[first], chain[last], 0, circle.center, circle.radius};
    for (std::size_t k = first; k < last; ++k)
      arc.sweep += angle_between(chain[k] - circle.center, chain[k + 1] - circle.center);
    if (first < last) out.push_back(through_its_ends(arc));
    if (tail) out.push_back(line_between(chain[last], chain[last + 1]));
  }

  /// Appends the curves of a chain that is no arc of a known circle: a line, or biarcs.
  void add_chain(const Ring& chain, bool is_closed, CurveRing& out) const {
    if (chain.size() == 2) {
      out.push_back(line_between(chain.front(), chain.back()));
      return;
    }
    for (const OutlineCurve& c : biarcs_along(chain, is_closed, 0.5 * tolerance_)) out.push_back(c);
  }

  Ring ring_;
  std::span<const Disc> circles_;
  double tolerance_;
  std::vector<int> circle_;
};

/// Returns the vertices of a ring that are apart from each other and not on a line with their
/// neighbours.
Ring essential(const Ring& ring) {
  Ring apart;
  for (const Vec2& p : ring)
    if (apart.empty() || (p - apart.back()).norm() > kSameDistance) apart.push_back(p);
  while (apart.size() > 1 && (apart.back() - apart.front()).norm() <= kSameDistance)
    apart.pop_back();
  Ring out;
  const std::size_t n = apart.size();
  for (std::size_t k = 0; k < n; ++k) {
    const Vec2 before = apart[k] - apart[(k + n - 1) % n], after = apart[(k + 1) % n] - apart[k];
    const bool straight = before.dot(after) > 0 && std::abs(cross(before, after)) <=
                                                       kRoundOff * before.norm() * after.norm();
    if (!straight) out.push_back(apart[k]);
  }
  return out;
}

template <class Make>
CurvedRegion curved(const Region& region, const Make& curves) {
  CurvedRegion out{curves(region.outer), {}};
  for (const Ring& hole : region.holes) out.holes.push_back(curves(hole));
  return out;
}

/// Returns true if the curves of a region neither cross nor touch and bound an area.
bool is_simple(const CurvedRegion& region, double tolerance) {
  std::vector<Ring> rings = {polygon_within(region.outer, tolerance)};
  for (const CurveRing& hole : region.holes) rings.push_back(polygon_within(hole, tolerance));
  try {
    region_of(std::move(rings));
    return true;
  } catch (const Error&) {
    return false;
  }
}

/// Returns the curves of a region. If they would cross, finer curves are used, and lines if these
/// would cross, too.
CurvedRegion uncrossed(const Region& region, std::span<const Disc> circles, double tolerance) {
  constexpr double kFiner = 0.1;
  // tolerance of the polygons with which crossings are tested
  const double sides = kFiner * tolerance;
  const auto fit = [&](double within) {
    return curved(region,
                  [&](const Ring& ring) { return RingCurves(ring, circles, within).curves(); });
  };
  CurvedRegion first = fit(tolerance);
  if (is_simple(first, sides)) return first;
  CurvedRegion finer = fit(kFiner * tolerance);
  if (is_simple(finer, sides)) return finer;
  CurvedRegion lines = curved(region, [](const Ring& ring) { return lines_of(ring); });
  // If the region touches itself, its curves touch as well.
  return is_simple(lines, sides) ? lines : first;
}

}  // namespace

Vec2 OutlineCurve::at(double share) const {
  if (share == 0) return from;
  if (share == 1) return to;
  if (is_line()) return from + share * (to - from);
  const double c = std::cos(share * sweep), s = std::sin(share * sweep);
  const Vec2 r = from - center;
  return center + Vec2(c * r.x() - s * r.y(), s * r.x() + c * r.y());
}

OutlineCurve line_between(const Vec2& from, const Vec2& to) { return {from, to, 0, {0, 0}, 0}; }

OutlineCurve arc_between(const Vec2& from, const Vec2& to, double sweep) {
  const Vec2 half = 0.5 * (to - from), left(-half.y(), half.x());
  return {from, to, sweep, from + half + left / std::tan(0.5 * sweep),
          half.norm() / std::abs(std::sin(0.5 * sweep))};
}

OutlineCurve full_circle(const Vec2& center, double radius) {
  const Vec2 at = center + Vec2(radius, 0);
  return {at, at, 2 * kPi, center, radius};
}

CurveRing lines_of(std::span<const Vec2> polygon) {
  CurveRing out;
  for (std::size_t k = 0; k < polygon.size(); ++k)
    out.push_back(line_between(polygon[k], polygon[(k + 1) % polygon.size()]));
  return out;
}

std::vector<CurvedRegion> curves_of(std::span<const Region> regions, double tolerance) {
  if (!(tolerance > 0)) throw Error::input("curves: the tolerance must be positive");
  std::vector<Region> clean;
  for (const Region& r : regions) {
    Region& out = clean.emplace_back();
    out.outer = essential(r.outer);
    for (const Ring& hole : r.holes) out.holes.push_back(essential(hole));
    std::erase_if(out.holes, [](const Ring& hole) { return hole.size() < 3; });
    if (out.outer.size() < 3) clean.pop_back();
  }
  std::vector<Ring> rings;
  for (const Region& r : clean)
    for (Ring& ring : rings_of(r)) rings.push_back(std::move(ring));
  const std::vector<Disc> circles = circles_of(rings, tolerance);
  std::vector<CurvedRegion> out;
  for (const Region& r : clean) out.push_back(uncrossed(r, circles, tolerance));
  return out;
}

std::vector<Vec2> polygon_within(const CurveRing& ring, double tolerance) {
  std::vector<Vec2> out;
  for (const OutlineCurve& c : ring) {
    // The middle of a chord of the angle w is r (1 - cos(w/2)) = 2 r sin²(w/4) away from the
    // circle.
    int parts = 1;
    if (!c.is_line()) {
      const double quarter = std::asin(std::min(1.0, std::sqrt(0.5 * tolerance / c.radius)));
      parts = std::max(c.is_circle() ? 8 : 1,
                       static_cast<int>(std::ceil(0.25 * std::abs(c.sweep) / quarter)));
    }
    for (int k = 0; k < parts; ++k) out.push_back(c.at(k / double(parts)));
  }
  return out;
}

double area(const CurvedRegion& region) {
  double sum = area(region.outer);
  for (const CurveRing& hole : region.holes) sum += area(hole);
  return sum;
}

double area(std::span<const CurvedRegion> regions) {
  double sum = 0;
  for (const CurvedRegion& r : regions) sum += area(r);
  return sum;
}

}  // namespace flexmorph
