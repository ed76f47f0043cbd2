#pragma once

#include <span>
#include <vector>

#include "geometry/components/outline.h"

/// Outlines for manufacturing: closed chains of lines and arcs.
namespace flexmorph {

/// A line, an arc or a full circle between two points [m].
struct OutlineCurve {
  Vec2 from{0, 0}, to{0, 0};  ///< First and last point [m].

  /// Angle of an arc, positive counterclockwise, at most 2π; 0 for a line [rad].
  double sweep = 0;
  Vec2 center{0, 0};  ///< Center of an arc [m].
  double radius = 0;  ///< Radius of an arc [m].

  /// Returns true if the curve is a line.
  bool is_line() const { return sweep == 0; }
  /// Returns true if the curve is a full circle.
  bool is_circle() const { return !is_line() && from == to; }
  /// Returns the point at a fraction of the length: `from` at 0, `to` at 1 [m].
  Vec2 at(double share) const;
};

/// A closed chain of curves. Each curve ends exactly (bit for bit) where the next one begins.
using CurveRing = std::vector<OutlineCurve>;

/// A region that curves bound.
struct CurvedRegion {
  CurveRing outer;               ///< Outer ring, counterclockwise.
  std::vector<CurveRing> holes;  ///< Rings of the holes, clockwise.
};

/// Returns the line between two points.
OutlineCurve line_between(const Vec2& from, const Vec2& to);
/// Returns the arc between two points that turns by `sweep` [rad], which is neither 0 nor 2π.
OutlineCurve arc_between(const Vec2& from, const Vec2& to, double sweep);
/// Returns the full circle around a point, counterclockwise.
OutlineCurve full_circle(const Vec2& center, double radius);
/// Returns the closed chain of the sides of a polygon.
CurveRing lines_of(std::span<const Vec2> polygon);

/// Returns curves for polygons, in the order of the polygons. The polygons are a union of smooth
/// outlines and straight sides.
///
/// Consecutive vertices that lie on one circle to round-off, such as those of circle_within() and
/// of drawn arcs, become an arc or a full circle. The end of such an arc is its intersection with
/// the neighbouring line or circle. Consecutive vertices on one line become a line. Sides between
/// other vertices become arcs that are tangent to each other (biarcs), except at corners, which are
/// kept. These curves are within half the tolerance of the polygon. Where curves would cross, for
/// example in slits narrower than the tolerance, a smaller tolerance or lines are used.
///
/// @param tolerance  tolerance of the curves [m]. The sides of the polygons must be within half of
///         it of the true outlines; sides of circles within all of it.
/// @throws Error (input) when the tolerance is not positive.
std::vector<CurvedRegion> curves_of(std::span<const Region> regions, double tolerance);

/// Returns a polygon whose vertices lie on the curves and whose sides are within `tolerance` of
/// them [m]. It has the sense of rotation of the ring.
std::vector<Vec2> polygon_within(const CurveRing& ring, double tolerance);

/// Returns the exact area of a region that curves bound [m^2].
double area(const CurvedRegion& region);
/// Returns the sum of the exact areas of regions [m^2].
double area(std::span<const CurvedRegion> regions);

}  // namespace flexmorph
