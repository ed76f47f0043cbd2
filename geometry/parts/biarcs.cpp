#include "geometry/parts/biarcs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace flexmorph {
namespace {

using Points = std::span<const Vec2>;

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Returns the angle from one direction to another [rad].
double angle_between(const Vec2& a, const Vec2& b) { return std::atan2(cross(a, b), a.dot(b)); }

Vec2 turned(const Vec2& v, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * v.x() - s * v.y(), s * v.x() + c * v.y()};
}

/// Returns unit tangents at the points of a polyline. An inner point has the tangent of the circle
/// through it and its two neighbours; an end has that of the circle through it and the next two
/// points.
///
/// On the circle through a, b, c a tangent and a chord that meet in a point differ by the inscribed
/// angle over the chord. Therefore the tangents at b and c differ from c - b by the angle at a, and
/// the tangent at a differs from b - a by the angle at c.
std::vector<Vec2> tangents_of(Points points, bool closed) {
  const std::size_t last = points.size() - 1;
  if (last == 1) return std::vector<Vec2>(2, (points[1] - points[0]).normalized());
  const auto inner = [](const Vec2& a, const Vec2& b, const Vec2& c) {
    return turned((c - b).normalized(), -angle_between(b - a, c - a));
  };
  std::vector<Vec2> out(points.size());
  for (std::size_t k = 1; k < last; ++k) out[k] = inner(points[k - 1], points[k], points[k + 1]);
  if (closed) {
    out[0] = out[last] = inner(points[last - 1], points[0], points[1]);
    return out;
  }
  const Vec2 &a = points[0], &b = points[1], &c = points[2];
  out[0] = turned((b - a).normalized(), -angle_between(c - a, c - b));
  const Vec2 &d = points[last - 2], &e = points[last - 1], &f = points[last];
  out[last] = turned((f - e).normalized(), angle_between(e - d, f - d));
  return out;
}

using Pair = std::array<OutlineCurve, 2>;

/// Fits pairs of arcs to a polyline.
class Fitter {
 public:
  Fitter(Points points, bool closed, double tolerance)
      : points_(points),
        tangents_(tangents_of(points, closed)),
        closed_(closed),
        tolerance_(tolerance) {}

  CurveRing chain() const {
    CurveRing out;
    for (std::size_t from = 0; from + 1 < points_.size();) {
      const std::size_t to = farthest(from);
      if (const std::optional<Pair> pair = fit(from, to)) {
        add(*pair, out);
      } else {
        out.push_back(line_between(points_[from], points_[to]));
      }
      from = to;
    }
    return out;
  }

 private:
  /// Returns the farthest point to which a pair of arcs fits, by doubling and bisecting the step.
  std::size_t farthest(std::size_t from) const {
    // largest number of points, because distances to all of them are computed
    constexpr std::size_t kMaxPointsOfArc = 256;
    const std::size_t end = std::min(points_.size() - 1, from + kMaxPointsOfArc);
    std::size_t good = from + 1, bad = end + 1;
    for (std::size_t step = 2; from + step < bad; step *= 2) {
      if (fit(from, from + step))
        good = from + step;
      else
        bad = from + step;
    }
    while (good + 1 < bad) {
      const std::size_t middle = good + (bad - good) / 2;
      (fit(from, middle) ? good : bad) = middle;
    }
    return good;
  }

  /// Returns the pair of arcs from one point of the polyline to another. At an end of an open
  /// polyline the direction is free; there a single arc is tried first.
  std::optional<Pair> fit(std::size_t from, std::size_t to) const {
    const Vec2 v = points_[to] - points_[from], &s = tangents_[from], &t = tangents_[to];
    const bool begins = !closed_ && from == 0, ends = !closed_ && to + 1 == points_.size();
    if (begins || ends) {
      // The direction at the second end of an arc is the first one mirrored about the chord.
      const auto mirrored = [&](const Vec2& d) -> Vec2 {
        return 2 * d.dot(v) / v.squaredNorm() * v - d;
      };
      const Vec2 first = !begins ? s : ends ? (s + mirrored(t)).normalized() : mirrored(t);
      if (std::optional<Pair> one = pair_of(from, to, first, mirrored(first))) return one;
    }
    return pair_of(from, to, s, t);
  }

  /// Returns the pair of arcs with given directions at its ends; nothing if it is not within the
  /// tolerance.
  ///
  ///   p, q    ends, v = q - p;   s, t  directions there
  ///   m = (p + q + d (s - t)) / 2    common point of the arcs: the middle between p + d s and
  ///                                  q - d t, whose distance is 2 d
  ///   2 d² (1 - s·t) + 2 d v·(s + t) = v·v
  ///
  /// Source: Bolton (1975), Biarc curves, Computer-Aided Design 7, 89-92.
  std::optional<Pair> pair_of(std::size_t from, std::size_t to, const Vec2& s,
                              const Vec2& t) const {
    const Vec2 &p = points_[from], &q = points_[to];
    const Vec2 v = q - p;
    const double a = 2 * (1 - s.dot(t)), b = v.dot(s + t), square = v.squaredNorm();
    const double d = square / (b + std::sqrt(b * b + a * square));
    if (!(b > 0) || !std::isfinite(d)) return {};
    const Vec2 m = 0.5 * (p + q + d * (s - t));
    const std::optional<OutlineCurve> first = arc(p, m, angle_between(s, m - p)),
                                      second = arc(m, q, angle_between(q - m, t));
    if (!first || !second) return {};
    const Pair pair = {*first, *second};
    if (!is_near(pair, points_.subspan(from, to - from + 1))) return {};
    return pair;
  }

  /// Returns the arc whose chord differs from the directions at both ends by an angle. The result
  /// is a line if the arc is nearly straight, and nothing if it turns by more than 1.6 rad (about
  /// 90 degrees).
  std::optional<OutlineCurve> arc(const Vec2& from, const Vec2& to, double half_sweep) const {
    constexpr double kLargest = 0.8, kStraight = 0.01;
    if (!(std::abs(half_sweep) < kLargest)) return {};
    const double sagitta = 0.5 * (to - from).norm() * std::tan(0.5 * std::abs(half_sweep));
    if (sagitta < kStraight * tolerance_) return line_between(from, to);
    return arc_between(from, to, 2 * half_sweep);
  }

  /// Appends a pair of arcs, or a single curve if both arcs coincide with it.
  void add(const Pair& pair, CurveRing& out) const {
    constexpr double kOne = 0.01;
    const OutlineCurve &first = pair[0], &second = pair[1];
    const double sweep = first.sweep + second.sweep;
    if (first.is_line() == second.is_line() && first.sweep * second.sweep >= 0) {
      const OutlineCurve both = sweep == 0 ? line_between(first.from, second.to)
                                           : arc_between(first.from, second.to, sweep);
      const auto is_near_both = [&](const Vec2& p) {
        return distance_to(both, p) < kOne * tolerance_;
      };
      if (is_near_both(first.to) && is_near_both(first.at(0.5)) && is_near_both(second.at(0.5))) {
        out.push_back(both);
        return;
      }
    }
    out.insert(out.end(), pair.begin(), pair.end());
  }

  /// Returns true if the polyline is near the arcs and the arcs are near the polyline.
  bool is_near(const Pair& pair, Points points) const {
    constexpr int kParts = 4;
    // the remainder is for arcs that are replaced by lines or merged
    const double limit = 0.95 * tolerance_;
    for (std::size_t k = 0; k + 1 < points.size(); ++k)
      for (int part = k == 0 ? 1 : 0; part < kParts; ++part) {
        const Vec2 at = points[k] + part / double(kParts) * (points[k + 1] - points[k]);
        if (distance_to(pair[0], at) > limit && distance_to(pair[1], at) > limit) return false;
      }
    const int samples = static_cast<int>(2 * points.size());
    for (const OutlineCurve& curve : pair)
      for (int k = 1; k < samples; ++k)
        if (distance_to(points, curve.at(k / double(samples))) > limit) return false;
    return true;
  }

  static double distance_to(const OutlineCurve& curve, const Vec2& p) {
    if (curve.is_line()) return distance_to(std::array{curve.from, curve.to}, p);
    const double turn = angle_between(curve.from - curve.center, p - curve.center);
    if (turn * curve.sweep >= 0 && std::abs(turn) <= std::abs(curve.sweep))
      return std::abs((p - curve.center).norm() - curve.radius);
    return std::min((p - curve.from).norm(), (p - curve.to).norm());
  }
  static double distance_to(Points points, const Vec2& p) {
    double least = INFINITY;
    for (std::size_t k = 0; k + 1 < points.size(); ++k) {
      const Vec2 side = points[k + 1] - points[k], to = p - points[k];
      const double share = std::clamp(to.dot(side) / side.squaredNorm(), 0.0, 1.0);
      least = std::min(least, (to - share * side).squaredNorm());
    }
    return std::sqrt(least);
  }

  Points points_;
  std::vector<Vec2> tangents_;
  bool closed_;
  double tolerance_;
};

}  // namespace

CurveRing biarcs_along(Points points, bool closed, double tolerance) {
  return Fitter(points, closed, tolerance).chain();
}

}  // namespace flexmorph
