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
/// The formula is P (26) with coefficients that are scaled with L. clamp() is the identity on [-1,
/// 1]; between |x / L| = 1 and 1 + 2 kBeyond it changes smoothly to the constant ±(1 + kBeyond). r
/// is the lower bound (see profile()). T is double or a number type that carries derivatives. The
/// functions have no branches, so that loops over nodes can use SIMD instructions.
template <class T>
class HalfThickness {
 public:
  /// Excess of the largest |ξ| over 1: |ξ| is 1 + kBeyond for |x / L| >= 1 + 2 kBeyond.
  static constexpr double kBeyond = 0.1;

  /// Stores the parameters; `minimum` is the lower bound of g [m].
  HalfThickness(T half_length, T c1, T c2, T c3, double minimum)
      : half_length_(half_length),
        per_length_(1 / half_length),
        a_(0.5 * (c1 + c2) - c3),
        b_(0.5 * (c2 - c1)),
        c3_(c3),
        minimum_(minimum),
        rounding_(0.1 * minimum) {}

  /// Returns the half-length L [m].
  const T& half_length() const { return half_length_; }
  /// Returns 1 / L [1/m].
  const T& per_length() const { return per_length_; }

  /// Returns the half-thickness g(x) [m].
  T operator()(const T& x) const {
    const T xi = clamped(T(x * per_length_)).value;
    return bounded(T((a_ * xi + b_) * xi + c3_)).value;
  }

  /// Returns g(x) and its derivatives.
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

  /// Returns the smallest and the largest g for ξ in [lower, upper] [m].
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

  /// Clamps x / L. Beyond 1 the derivative is 1 - t² (3 - 2 t), where t grows from 0 to 1 over 2
  /// kBeyond.
  static Smooth clamped(const T& raw) {
    const T size = raw < 0 ? T(-raw) : raw;
    const T t = between(T((size - 1) * (0.5 / kBeyond)));
    const T value = (size < 1 ? size : T(1)) + 2 * kBeyond * t * (1 - t * t * (1 - 0.5 * t));
    return {raw < 0 ? T(-value) : value, 1 - t * t * (3 - 2 * t)};
  }

  /// Applies the lower bound: m below m - d, g above m + d; between them the derivative is t² (3 -
  /// 2 t).
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

/// The frame of a component: everything that does not depend on the point at which it is evaluated.
///
///   x =  cos θ (X - X0) + sin θ (Y - Y0),    y = -sin θ (X - X0) + cos θ (Y - Y0)     P (25)
class ComponentFrame {
 public:
  /// Prepares a component; `min_half_thickness` is the lower bound of its profile [m].
  ComponentFrame(const Component& c, double min_half_thickness)
      : center_x_(c.center.x()),
        center_y_(c.center.y()),
        cos_(std::cos(c.angle)),
        sin_(std::sin(c.angle)),
        shape_(c.half_length, c.c1, c.c2, c.c3, min_half_thickness) {}

  /// Returns the local coordinate x along the axis of a point (X, Y) of the plane [m].
  double x(double X, double Y) const { return cos_ * (X - center_x_) + sin_ * (Y - center_y_); }
  /// Returns the local coordinate y across the axis of a point (X, Y) of the plane [m].
  double y(double X, double Y) const { return cos_ * (Y - center_y_) - sin_ * (X - center_x_); }
  /// Returns cos θ of the component's angle.
  double cosine() const { return cos_; }
  /// Returns sin θ of the component's angle.
  double sine() const { return sin_; }
  /// Returns the half-length L [m].
  double half_length() const { return shape_.half_length(); }
  /// Returns 1 / L [1/m].
  double per_length() const { return shape_.per_length(); }
  /// Returns the half-thickness as a function of the local x.
  const HalfThickness<double>& shape() const { return shape_; }

  /// Returns the half-thickness g(x) [m].
  double half_thickness(double x) const { return shape_(x); }
  /// Returns g(x) and its derivatives.
  Profile profile(double x) const { return shape_.profile(x); }
  /// Returns the largest g over [-L, L] [m].
  double largest_half_thickness() const { return shape_.range(-1, 1).second; }

  /// An interval of Y on a vertical line; it is empty when lower > upper [m].
  struct Interval {
    double lower, upper;  ///< Lower and upper end [m].
  };
  /// Returns the interval of the vertical line at X that lies in a rectangle of the component's
  /// frame.
  Interval column(double X, const Box& local) const {
    const double dX = X - center_x_;
    const Interval along = strip(cos_ * dX, sin_, local.lower.x(), local.upper.x());
    const Interval across = strip(-sin_ * dX, cos_, local.lower.y(), local.upper.y());
    return {center_y_ + std::max(along.lower, across.lower),
            center_y_ + std::min(along.upper, across.upper)};
  }

  /// Returns the smallest axis-aligned box around a rectangle of the component's frame [m].
  Box enclosing(const Box& local) const {
    const Vec2 middle = 0.5 * (local.lower + local.upper), half = 0.5 * (local.upper - local.lower);
    const Vec2 center(center_x_ + cos_ * middle.x() - sin_ * middle.y(),
                      center_y_ + sin_ * middle.x() + cos_ * middle.y());
    const Vec2 reach(std::abs(cos_) * half.x() + std::abs(sin_) * half.y(),
                     std::abs(sin_) * half.x() + std::abs(cos_) * half.y());
    return {center - reach, center + reach};
  }

 private:
  // Returns all t with lower <= offset + slope t <= upper.
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

/// The indices first <= k < end of a range.
struct IndexRange {
  int first, end;  ///< First index, and the index after the last one.
};
/// Returns the indices 0 <= k < count of the points origin + k step that lie in an interval.
inline IndexRange indices_in(const ComponentFrame::Interval& range, double origin, double step,
                             int count) {
  const double top = count;
  const double first = std::clamp(std::ceil((range.lower - origin) / step), 0.0, top);
  const double end = std::clamp(std::floor((range.upper - origin) / step) + 1, 0.0, top);
  return {static_cast<int>(first), static_cast<int>(std::max(first, end))};
}

}  // namespace flexmorph
