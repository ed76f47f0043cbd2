#include "fem/shapes/plane_curve.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace flexmorph::fem {
namespace {

constexpr int kParts = 512;  // intervals between sample points

}  // namespace

PlaneCurve::PlaneCurve(Coordinate x, Coordinate y, double until)
    : x_(std::move(x)), y_(std::move(y)), until_(until) {
  for (int i = 0; i <= kParts; ++i) samples_.push_back(at(until_ * i / kParts).c);
  const At first = at(0), last = at(until_);
  closed_ = (first.c - last.c).norm() <= 1e-6 * length() &&
            (first.c_s - last.c_s).norm() <= 1e-4 * first.c_s.norm();
}

PlaneCurve::At PlaneCurve::at(double s) const {
  const Motion x = x_(s), y = y_(s);
  return {{x.value, y.value}, {x.rate, y.rate}, {x.acceleration, y.acceleration}};
}

double PlaneCurve::length() const {
  double out = 0;
  for (size_t i = 0; i < kParts; ++i) out += (samples_[i + 1] - samples_[i]).norm();
  return out;
}

double PlaneCurve::corner() const {
  Vec2 before(0, 0);
  for (int i = 0; i <= kParts; ++i) {
    const Vec2 c_s = at(until_ * i / kParts).c_s;
    if (!(c_s.norm() > 1e-9 * length() / until_) || (i > 0 && c_s.dot(before) <= 0))
      return until_ * i / kParts;
    before = c_s;
  }
  return -1;
}

bool PlaneCurve::crosses_itself() const {
  // Returns true if x and y lie on one side of the line through a and b, with a tolerance for
  // round-off.
  const auto aside = [](const Vec2& a, const Vec2& b, const Vec2& x, const Vec2& y) {
    const Vec2 n(a.y() - b.y(), b.x() - a.x());
    const double slack = 1e-9 * n.squaredNorm(), u = n.dot(x - a), v = n.dot(y - a);
    return (u > slack && v > slack) || (u < -slack && v < -slack);
  };
  for (size_t i = 0; i < kParts; ++i)
    for (size_t j = i + 2; j < kParts; ++j) {
      if (closed_ && i == 0 && j == kParts - 1) continue;  // neighbouring chords
      const Vec2 &a = samples_[i], &b = samples_[i + 1], &c = samples_[j], &d = samples_[j + 1];
      const double near = 0.5 * ((b - a).norm() + (d - c).norm());
      // These chords are too far apart to cross. The test also excludes collinear chords, for which
      // aside() is false.
      if ((0.5 * (a + b - c - d)).norm() > near) continue;
      if (!aside(a, b, c, d) && !aside(c, d, a, b)) return true;
    }
  return false;
}

double PlaneCurve::nearest(const Vec2& p) const {
  size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i <= kParts; ++i)
    if (const double d = (samples_[i] - p).squaredNorm(); d < least) least = d, best = i;
  const double part = until_ / kParts;
  double s = part * static_cast<double>(best);
  for (int k = 0; k < 50; ++k) {
    const At c = at(inside(s));
    const double square = c.c_s.squaredNorm();
    // Beyond the centre of curvature the second derivative of the distance is not positive. The
    // lower bound, a tenth of the Gauss-Newton term, keeps a descent direction there.
    const double slope = std::max(square - (p - c.c).dot(c.c_ss), 0.1 * square);
    const double step = std::clamp((p - c.c).dot(c.c_s) / slope, -2 * part, 2 * part);
    s += step;
    if (std::abs(step) < 1e-15 * until_) break;
  }
  return inside(s);
}

double PlaneCurve::inside(double s) const {
  return closed_ ? s - until_ * std::floor(s / until_) : s;
}

}  // namespace flexmorph::fem
