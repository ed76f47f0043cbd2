#pragma once

#include <functional>
#include <vector>

#include "fem/element.h"

namespace flexmorph::fem {

/// A curve c(s) in the plane, 0 <= s <= until [m], with its derivatives c' and c''. It is closed
/// where both ends agree in place and direction. 513 points at equal distances of the parameter are
/// kept: searches begin at them, and the checks look at them.
class PlaneCurve {
 public:
  /// One coordinate as a function of the parameter s, with its derivatives by s [m].
  using Coordinate = std::function<Motion(double s)>;
  /// The curve and its derivatives at one parameter [m].
  struct At {
    Vec2 c, c_s, c_ss;
  };

  /// Evaluates the coordinates at all kept points.
  PlaneCurve(Coordinate x, Coordinate y, double until);

  /// Returns the curve at a parameter; beyond its ends as the coordinates go on there.
  At at(double s) const;
  /// Returns the parameter at which the curve ends.
  double until() const { return until_; }
  /// Says whether both ends are one point with one direction.
  bool is_closed() const { return closed_; }
  /// Returns the length of the polygon through the kept points [m].
  double length() const;

  /// Returns the first kept parameter at which the curve has no direction, or has turned by more
  /// than a quarter since the kept point before (a corner); -1 where there is none.
  double corner() const;
  /// Says whether two chords between neighbouring kept points cross or meet.
  bool crosses_itself() const;

  /// Returns the parameter of the point of the curve that is nearest to p, by Newton's method for
  /// (p - c) · c' = 0 from the nearest kept point: it depends on p alone, not on earlier calls.
  double nearest(const Vec2& p) const;

 private:
  /// Takes a parameter back into [0, until] along a closed curve.
  double inside(double s) const;

  Coordinate x_, y_;
  double until_;
  bool closed_ = false;
  std::vector<Vec2> samples_;
};

}  // namespace flexmorph::fem
