#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/components/component.h"

namespace flexmorph {

/// The half-thickness of a component along its axis, twice continuously differentiable.
///
///   g = r(a ξ² + b ξ + c3),   ξ = clamp(x / L),   a = (c1 + c2)/2 - c3,   b = (c2 - c1)/2
///
/// P (26), its coefficients scaled with L. clamp() is the identity on [-1, 1] and comes to rest at
/// ±(1 + kBeyond) over twice that distance; r is the lower bound (see profile()). T is a number, or
/// one that carries derivatives. Free of branches, because loops over nodes are made of it.
template <class T>
class HalfThickness {
 public:
  /// ξ is constant from 1 + 2 kBeyond on, and 1 + kBeyond there.
  static constexpr double kBeyond = 0.1;

  HalfThickness(T half_length, T c1, T c2, T c3, double minimum)
      : half_length_(half_length),
        per_length_(1 / half_length),
        a_(0.5 * (c1 + c2) - c3),
        b_(0.5 * (c2 - c1)),
        c3_(c3),
        minimum_(minimum),
        rounding_(0.1 * minimum) {}

  const T& half_length() const { return half_length_; }
  const T& per_length() const { return per_length_; }  ///< 1 / L

  /// g(x)   [m]
  T operator()(const T& x) const {
    const T xi = clamped(T(x * per_length_)).value;
    return bounded(T((a_ * xi + b_) * xi + c3_)).value;
  }

  /// g(x) and its derivatives.
  BasicProfile<T> profile(const T& x) const {
    const T raw = x * per_length_;
    const Smooth xi = clamped(raw);
    const Smooth g = bounded(T((a_ * xi.value + b_) * xi.value + c3_));
    const T by_raw = g.slope * (2 * a_ * xi.value + b_) * xi.slope;
    return {g.value,
            by_raw * per_length_,
            {-raw * by_raw * per_length_, 0.5 * g.slope * (xi.value - 1) * xi.value,
             0.5 * g.slope * (xi.value + 1) * xi.value, g.slope * (1 - xi.value * xi.value)}};
  }

  /// Smallest and largest g for ξ in [lower, upper]   [m].
  std::pair<T, T> range(double lower, double upper) const {
    const auto at = [&](const T& xi) { return T((a_ * xi + b_) * xi + c3_); };
    const T ends[2] = {at(T(lower)), at(T(upper))};
    T low = std::min(ends[0], ends[1]), high = std::max(ends[0], ends[1]);
    if (a_ != 0) {
      const T top = -b_ / (2 * a_);
      if (top > lower && top < upper) {
        low = std::min(low, at(top));
        high = std::max(high, at(top));
      }
    }
    return {bounded(low).value, bounded(high).value};
  }

 private:
  struct Smooth {
    T value, slope;
  };

  /// The slope beyond 1 is 1 - t² (3 - 2 t), t from 0 to 1 over 2 kBeyond.
  static Smooth clamped(const T& raw) {
    const T size = raw < 0 ? T(-raw) : raw;
    const T t = between(T((size - 1) * (0.5 / kBeyond)));
    const T value = (size < 1 ? size : T(1)) + 2 * kBeyond * t * (1 - t * t * (1 - 0.5 * t));
    return {raw < 0 ? T(-value) : value, 1 - t * t * (3 - 2 * t)};
  }

  /// m below m - d, g above m + d; the slope between is t² (3 - 2 t).
  Smooth bounded(const T& g) const {
    const T t = between(T((g - minimum_ + rounding_) * (0.5 / rounding_)));
    const T above = g - minimum_ - rounding_;
    const T value =
        minimum_ + 2 * rounding_ * t * t * t * (1 - 0.5 * t) + (above > 0 ? above : T(0));
    return {value, t * t * (3 - 2 * t)};
  }

  static T between(const T& t) { return t < 0 ? T(0) : t > 1 ? T(1) : t; }

  T half_length_, per_length_, a_, b_, c3_;
  double minimum_, rounding_;
};

/// A component prepared for many points: everything that does not depend on the point.
///
///   x =  cos θ (X - X0) + sin θ (Y - Y0),    y = -sin θ (X - X0) + cos θ (Y - Y0)     P (25)
class ComponentFrame {
 public:
  ComponentFrame(const Component& c, double min_half_thickness)
      : center_x_(c.center.x()),
        center_y_(c.center.y()),
        cos_(std::cos(c.angle)),
        sin_(std::sin(c.angle)),
        shape_(c.half_length, c.c1, c.c2, c.c3, min_half_thickness) {}

  double x(double X, double Y) const { return cos_ * (X - center_x_) + sin_ * (Y - center_y_); }
  double y(double X, double Y) const { return cos_ * (Y - center_y_) - sin_ * (X - center_x_); }
  double cosine() const { return cos_; }
  double sine() const { return sin_; }
  double half_length() const { return shape_.half_length(); }
  double per_length() const { return shape_.per_length(); }  ///< 1 / L
  const HalfThickness<double>& shape() const { return shape_; }

  /// g(x)   [m]
  double half_thickness(double x) const { return shape_(x); }
  /// g(x) and its derivatives.
  Profile profile(double x) const { return shape_.profile(x); }
  /// max g over [-L, L]   [m]
  double largest_half_thickness() const { return shape_.range(-1, 1).second; }

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
  HalfThickness<double> shape_;
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
