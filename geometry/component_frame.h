#pragma once

#include <algorithm>
#include <cmath>

#include "geometry/component.h"

namespace flexmorph {

/// A component prepared for many points: everything that does not depend on the point.
///
///   x =  cos θ (X - X0) + sin θ (Y - Y0),    y = -sin θ (X - X0) + cos θ (Y - Y0)     P (25)
///   g = a ξ² + b ξ + c3,   ξ = clamp(x / L, -1, 1),   a = (c1 + c2)/2 - c3,   b = (c2 - c1)/2
///
/// The second line is P (26), its coefficients scaled with L. All members are inline and free of
/// branches, because loops over nodes and samples are made of them.
class ComponentFrame {
 public:
  ComponentFrame(const Component& c, double min_half_thickness)
      : center_x_(c.center.x()),
        center_y_(c.center.y()),
        cos_(std::cos(c.angle)),
        sin_(std::sin(c.angle)),
        half_length_(c.half_length),
        per_length_(1 / c.half_length),
        a_(0.5 * (c.c1 + c.c2) - c.c3),
        b_(0.5 * (c.c2 - c.c1)),
        c3_(c.c3),
        minimum_(min_half_thickness),
        rounding_(0.1 * min_half_thickness) {}

  double x(double X, double Y) const { return cos_ * (X - center_x_) + sin_ * (Y - center_y_); }
  double y(double X, double Y) const { return cos_ * (Y - center_y_) - sin_ * (X - center_x_); }
  double cosine() const { return cos_; }
  double sine() const { return sin_; }
  double half_length() const { return half_length_; }
  double per_length() const { return per_length_; }  ///< 1 / L

  /// g(x)   [m]
  double half_thickness(double x) const {
    const double xi = std::clamp(x * per_length_, -1.0, 1.0);
    return bounded((a_ * xi + b_) * xi + c3_);
  }

  /// g(x) and its derivatives.
  Profile profile(double x) const {
    const double raw = x * per_length_;
    const double xi = std::clamp(raw, -1.0, 1.0);
    const double g = (a_ * xi + b_) * xi + c3_;
    const double slope = bounded_slope(g);
    const double dg_dx = raw > -1 && raw < 1 ? slope * (2 * a_ * xi + b_) * per_length_ : 0.0;
    return {bounded(g),
            dg_dx,
            {-xi * dg_dx, 0.5 * slope * (xi - 1) * xi, 0.5 * slope * (xi + 1) * xi,
             slope * (1 - xi * xi)}};
  }

  /// max g over [-L, L]   [m]
  double largest_half_thickness() const {
    const double ends = a_ + std::abs(b_) + c3_;
    const bool bulges = a_ < 0 && std::abs(b_) < -2 * a_;
    const double top = bulges ? c3_ - b_ * b_ / (4 * a_) : c3_;
    return bounded(std::max({ends, c3_, top}));
  }

  /// The part of the vertical line at X inside a rectangle of the component's frame: Y from
  /// lower to upper, empty when lower > upper   [m].
  struct Interval {
    double lower, upper;
  };
  Interval column(double X, const Box& local) const {
    const double dX = X - center_x_;
    const Interval along = strip(cos_ * dX, sin_, local.lower.x(), local.upper.x());
    const Interval across = strip(-sin_ * dX, cos_, local.lower.y(), local.upper.y());
    return {center_y_ + std::max(along.lower, across.lower),
            center_y_ + std::min(along.upper, across.upper)};
  }

  /// Smallest axis-aligned box around a rectangle of the component's frame   [m].
  Box enclosing(const Box& local) const {
    const Vec2 middle = 0.5 * (local.lower + local.upper), half = 0.5 * (local.upper - local.lower);
    const Vec2 center(center_x_ + cos_ * middle.x() - sin_ * middle.y(),
                      center_y_ + sin_ * middle.x() + cos_ * middle.y());
    const Vec2 reach(std::abs(cos_) * half.x() + std::abs(sin_) * half.y(),
                     std::abs(sin_) * half.x() + std::abs(cos_) * half.y());
    return {center - reach, center + reach};
  }

 private:
  // One formula for the three branches of profile(): the middle one, plus what g is above m + d.
  double bounded(double g) const {
    const double t = std::clamp(g - minimum_ + rounding_, 0.0, 2 * rounding_);
    return minimum_ + t * t / (4 * rounding_) + std::max(g - minimum_ - rounding_, 0.0);
  }
  double bounded_slope(double g) const {
    return std::clamp(g - minimum_ + rounding_, 0.0, 2 * rounding_) / (2 * rounding_);
  }

  // All t with lower <= offset + slope t <= upper.
  static Interval strip(double offset, double slope, double lower, double upper) {
    constexpr double kEverywhere = 1e300;
    if (slope == 0) {
      return offset >= lower && offset <= upper ? Interval{-kEverywhere, kEverywhere}
                                                : Interval{kEverywhere, -kEverywhere};
    }
    const double t1 = (lower - offset) / slope, t2 = (upper - offset) / slope;
    return {std::min(t1, t2), std::max(t1, t2)};
  }

  double center_x_, center_y_, cos_, sin_;
  double half_length_, per_length_;
  double a_, b_, c3_;
  double minimum_, rounding_;
};

/// Indices first <= k < end of the points origin + k step, 0 <= k < count, in an interval.
struct IndexRange {
  int first, end;
};
inline IndexRange indices_in(const ComponentFrame::Interval& range, double origin, double step,
                             int count) {
  const double top = count;
  const double first = std::clamp(std::ceil((range.lower - origin) / step), 0.0, top);
  const double end = std::clamp(std::floor((range.upper - origin) / step) + 1, 0.0, top);
  return {static_cast<int>(first), static_cast<int>(std::max(first, end))};
}

}  // namespace flexmorph
