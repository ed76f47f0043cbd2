#pragma once

#include <functional>
#include <vector>

#include "fem/element.h"

namespace flexmorph::fem {

/// A curve c(s) in the plane, 0 <= s <= until, in metres, with its derivatives c' and c''. It is
/// closed if both ends have the same position and direction. 513 sample points at equal distances
/// of the parameter are stored: searches start at them, and the checks use them.
class PlaneCurve {
 public:
  /// One coordinate as a function of the parameter s, with its derivatives by s [m].
  using Coordinate = std::function<Motion(double s)>;
  /// The curve and its derivatives at one parameter value.
  struct At {
    Vec2 c, c_s, c_ss;  ///< Position c and derivatives c', c'' by the parameter [m].
  };

  /// Creates the curve and evaluates the coordinates at all sample points.
  PlaneCurve(Coordinate x, Coordinate y, double until);

  /// Returns the curve at a parameter value; beyond the ends the coordinate functions are evaluated
  /// there.
  At at(double s) const;
  /// Returns the parameter value at which the curve ends.
  double until() const { return until_; }
  /// Returns true if both ends are one point with one direction.
  bool is_closed() const { return closed_; }
  /// Returns the length of the polygon through the sample points [m].
  double length() const;

  /// Returns the first sample parameter at which the curve has no direction, or differs by 90
  /// degrees or more from the direction at the previous sample point (a corner); -1 where there is
  /// none.
  double corner() const;
  /// Returns true if two chords between neighbouring sample points cross or touch.
  bool crosses_itself() const;

  /// Returns the parameter of the point of the curve that is nearest to p, by Newton's method for
  /// (p - c) · c' = 0 from the nearest sample point. The result depends on p alone, not on earlier
  /// calls.
  double nearest(const Vec2& p) const;

 private:
  /// Returns the parameter mapped into [0, until] along a closed curve.
  double inside(double s) const;

  Coordinate x_, y_;
  double until_;
  bool closed_ = false;
  std::vector<Vec2> samples_;
};

}  // namespace flexmorph::fem
