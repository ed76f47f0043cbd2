#include "geometry/parts/ring_circles.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <optional>

namespace flexmorph {
namespace {

/// Round-off limit, as a fraction of a radius or of the length of a run.
constexpr double kRoundOff = 1e-9;
/// Smallest number of consecutive vertices that define a circle. Four are not enough, because four
/// vertices lie on one circle wherever a curve is symmetric.
constexpr std::size_t kMinPoints = 5;

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Returns true if the side from a to b, whose ends lie on the circle, is near enough to it.
bool is_chord(const Disc& circle, const Vec2& a, const Vec2& b, double sagitta) {
  const double half = 0.5 * (b - a).norm(), r = circle.radius;
  return half < r && half * half <= sagitta * (r + std::sqrt(r * r - half * half));
}

/// Returns the circle through three points; nothing if they are nearly on a line.
std::optional<Disc> circle_through(const Vec2& a, const Vec2& b, const Vec2& c) {
  constexpr double kStraight = 1e-4;  // angle between the sides [rad]
  const Vec2 u = b - a, w = c - a;
  const double twice = 2 * cross(u, w);
  if (!(std::abs(twice) > 2 * kStraight * u.norm() * (c - b).norm())) return {};
  const double u2 = u.squaredNorm(), w2 = w.squaredNorm();
  const Vec2 to((w.y() * u2 - u.y() * w2) / twice, (u.x() * w2 - w.x() * u2) / twice);
  return Disc{a + to, to.norm()};
}

/// Returns the least-squares circle of points: |x - c|² = r² is linear in c and r² - |c|². `near`
/// is an approximation of the circle, by which the points are scaled.
Disc fitted(const Disc& near, std::span<const Vec2> points) {
  MatrixXd rows(static_cast<Eigen::Index>(points.size()), 3);
  VectorXd squares(rows.rows());
  for (Eigen::Index k = 0; k < rows.rows(); ++k) {
    const Vec2 p = (points[static_cast<std::size_t>(k)] - near.center) / near.radius;
    rows.row(k) << 2 * p.x(), 2 * p.y(), 1;
    squares[k] = p.squaredNorm();
  }
  const Vec3 x = rows.colPivHouseholderQr().solve(squares);
  const Vec2 center(x[0], x[1]);
  return {near.center + near.radius * center, near.radius * std::sqrt(x[2] + center.squaredNorm())};
}

/// Consecutive vertices of a ring on one circle, beginning with `first` (cyclic).
struct Run {
  Disc circle;
  std::size_t first = 0, count = 0;
};

/// Finds the longest run on a circle that contains three given vertices, in both directions.
class RunFinder {
 public:
  RunFinder(const std::vector<Vec2>& ring, double sagitta) : ring_(ring), sagitta_(sagitta) {}

  std::optional<Run> at(std::size_t first) const {
    const std::optional<Disc> begin =
        circle_through(vertex(first), vertex(first + 1), vertex(first + 2));
    if (!begin || !chord(*begin, first) || !chord(*begin, first + 1)) return {};
    Run run{*begin, first, 3};
    for (std::size_t fit = kMinPoints;
         grows(run, run.first + run.count - 1, run.first + run.count);) {
      ++run.count;
      if (run.count < fit) continue;
      fit = 2 * run.count;
      run.circle = fitted(run.circle, points_of(run));
    }
    if (run.count < kMinPoints) return {};
    const std::size_t n = ring_.size();
    while (grows(run, run.first + n - 1, run.first + n - 1)) {
      run.first = (run.first + n - 1) % n;
      ++run.count;
    }
    run.circle = fitted(run.circle, points_of(run));
    return run;
  }

  std::vector<Vec2> points_of(const Run& run) const {
    std::vector<Vec2> out;
    for (std::size_t k = 0; k < run.count; ++k) out.push_back(vertex(run.first + k));
    return out;
  }

 private:
  const Vec2& vertex(std::size_t k) const { return ring_[k % ring_.size()]; }
  bool chord(const Disc& circle, std::size_t k) const {
    return is_chord(circle, vertex(k), vertex(k + 1), sagitta_);
  }
  /// Returns true if the vertex `next`, at the free end of `side`, lies on the circle of a run.
  bool grows(const Run& run, std::size_t side, std::size_t next) const {
    if (run.count >= ring_.size() || !chord(run.circle, side)) return false;
    const double along =
        static_cast<double>(run.count - 1) * (vertex(run.first + 1) - vertex(run.first)).norm();
    return std::abs((vertex(next) - run.circle.center).norm() - run.circle.radius) <=
           kRoundOff * std::min(run.circle.radius, along);
  }

  const std::vector<Vec2>& ring_;
  double sagitta_;
};

struct Found {
  Disc circle;
  std::vector<Vec2> points;
};

/// Returns true if two circles differ by less than short arcs of them can resolve.
bool are_one(const Disc& a, const Disc& b) {
  constexpr double kDistanceTolerance = 1e-6;
  const double near = kDistanceTolerance * std::min(a.radius, b.radius);
  return (a.center - b.center).norm() <= near && std::abs(a.radius - b.radius) <= near;
}

}  // namespace

bool lies_on(const Disc& circle, const Vec2& point) {
  return std::abs((point - circle.center).norm() - circle.radius) <= kRoundOff * circle.radius;
}

std::vector<Disc> circles_of(std::span<const std::vector<Vec2>> rings, double sagitta) {
  std::vector<Found> found;
  for (const std::vector<Vec2>& ring : rings) {
    const RunFinder finder(ring, sagitta);
    if (ring.size() < kMinPoints) continue;
    std::vector<bool> known_side(ring.size(), false);
    for (std::size_t k = 0; k < ring.size(); ++k) {
      if (known_side[k]) continue;
      const std::optional<Run> run = finder.at(k);
      if (!run) continue;
      for (std::size_t j = 0; j + 1 < run->count; ++j)
        known_side[(run->first + j) % ring.size()] = true;
      const auto known = std::find_if(found.begin(), found.end(), [&](const Found& f) {
        return are_one(f.circle, run->circle);
      });
      const std::vector<Vec2> points = finder.points_of(*run);
      if (known == found.end())
        found.push_back({run->circle, points});
      else
        known->points.insert(known->points.end(), points.begin(), points.end());
    }
  }
  std::vector<Disc> out;
  for (const Found& f : found) out.push_back(fitted(f.circle, f.points));
  return out;
}

std::vector<int> circles_of_sides(std::span<const Vec2> ring, std::span<const Disc> circles,
                                  double sagitta) {
  std::vector<int> out(ring.size(), -1);
  // True if `inner` lies inside the circle on a chord that begins at `end`.
  const auto is_part = [&](const Disc& circle, const Vec2& end, const Vec2& inner) {
    const Vec2 radius = end - circle.center, side = inner - end;
    const double depth = circle.radius - (inner - circle.center).norm();
    // The angle between a chord and the tangent at its end is half the central angle of the chord.
    // For the longest chord its cosine is 1 - sagitta / radius.
    const double cosine = std::max(0.0, 1 - sagitta / circle.radius);
    return depth > 0 && depth <= sagitta &&
           std::abs(side.dot(radius)) <=
               1.01 * std::sqrt(1 - cosine * cosine) * side.norm() * radius.norm();
  };
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
    for (std::size_t c = 0; c < circles.size(); ++c) {
      const bool from = lies_on(circles[c], a), to = lies_on(circles[c], b);
      if (!from && !to) continue;
      const bool whole = from && to && is_chord(circles[c], a, b, sagitta);
      const bool part = from != to && is_part(circles[c], from ? a : b, from ? b : a);
      if (whole || (part && out[k] < 0)) out[k] = static_cast<int>(c);
      if (whole) break;
    }
  }
  return out;
}

}  // namespace flexmorph
