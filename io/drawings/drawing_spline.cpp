#include <algorithm>
#include <memory>
#include <utility>

#include "io/drawings/drawing.h"

/// Splines of drawings, evaluated by the algorithm of de Boor and Cox in homogeneous coordinates.
namespace flexmorph::io::drawing {
namespace {

constexpr unsigned kHighestDegree = 25;

void check(const Spline& s) {
  const std::size_t n = s.points.size();
  if (s.degree < 1 || s.degree > kHighestDegree || n < s.degree + 1 ||
      s.knots.size() != n + s.degree + 1)
    throw Error::input(
        "SPLINE of degree " + std::to_string(s.degree) + " with " + std::to_string(n) +
        " control points and " + std::to_string(s.knots.size()) +
        " knots: the degree must lie between 1 and " + std::to_string(kHighestDegree) +
        ", and the number of knots must be the number of control points + degree + 1");
  if (!std::is_sorted(s.knots.begin(), s.knots.end()))
    throw Error::input("SPLINE: its knots must be ascending");
  if (!std::all_of(s.weights.begin(), s.weights.end(), [](double w) { return w > 0; }))
    throw Error::input("SPLINE: its weights must be positive");
}

/// Returns the point at a parameter between the knots `span` and `span` + 1.
Vec2 point_at(const Spline& s, std::size_t span, double t) {
  std::vector<Vec3> d;
  for (std::size_t k = span - s.degree; k <= span; ++k) {
    const double w = s.weights[k];
    d.emplace_back(w * s.points[k].x(), w * s.points[k].y(), w);
  }
  for (unsigned r = 1; r <= s.degree; ++r)
    for (unsigned k = s.degree; k >= r; --k) {
      const std::size_t at = span - s.degree + k;
      const double low = s.knots[at], high = s.knots[at + s.degree + 1 - r];
      const double share = high > low ? (t - low) / (high - low) : 0;
      d[k] = (1 - share) * d[k - 1] + share * d[k];
    }
  const Vec3& p = d[s.degree];
  return Vec2(p.x(), p.y()) / p.z();
}

}  // namespace

std::vector<Curve> spline(Spline given) {
  check(given);
  const auto s = std::make_shared<const Spline>(std::move(given));
  std::vector<Curve> out;
  for (std::size_t span = s->degree; span < s->points.size(); ++span) {
    const double low = s->knots[span], high = s->knots[span + 1];
    if (!(high > low)) continue;
    out.push_back({[s, span, low, high](double t) {
                     return point_at(*s, span, t == 1 ? high : low + t * (high - low));
                   },
                   s->degree == 1});
  }
  if (out.empty()) throw Error::input("SPLINE: all its knots are equal");
  return out;
}

}  // namespace flexmorph::io::drawing
