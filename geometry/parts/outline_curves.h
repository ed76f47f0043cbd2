#pragma once

#include <span>
#include <vector>

#include "geometry/components/outline.h"

/// Outlines as a workshop cuts them: closed chains of lines and arcs.
namespace flexmorph {

/// A line, an arc or a full circle from one point to another [m].
struct OutlineCurve {
  Vec2 from{0, 0}, to{0, 0};
  double sweep = 0;   ///< angle of an arc, positive counterclockwise, at most 2π; 0: a line [rad]
  Vec2 center{0, 0};  ///< of an arc
  double radius = 0;  ///< of an arc

  bool is_line() const { return sweep == 0; }
  bool is_circle() const { return !is_line() && from == to; }
  /// Returns the point after a share of its length: 0 `from`, 1 `to`.
  Vec2 at(double share) const;
};

/// A closed chain: every curve ends where the next one begins, to the last bit.
using CurveRing = std::vector<OutlineCurve>;

/// A region bounded by curves: the outer ring is counterclockwise, holes are clockwise.
struct CurvedRegion {
  CurveRing outer;
  std::vector<CurveRing> holes;
};

/// Returns the line from one point to another.
OutlineCurve line_between(const Vec2& from, const Vec2& to);
/// Returns the arc from one point to another that turns by `sweep`, which is neither 0 nor 2π.
OutlineCurve arc_between(const Vec2& from, const Vec2& to, double sweep);
/// Returns the full circle around a point, counterclockwise.
OutlineCurve full_circle(const Vec2& center, double radius);
/// Returns the closed chain of the sides of a polygon.
CurveRing lines_of(std::span<const Vec2> polygon);

/// Returns the curves of polygons, in their order, that a union of smooth outlines and straight
/// sides made.
///
/// Vertices in a row that lie on one circle to round-off, as those of circle_within() and of drawn
/// arcs do, become an arc of it, or the circle; where such an arc ends, it meets its neighbour's
/// line or circle. Vertices in a row on one line become a line. Sides between other vertices become
/// arcs that go on in each other's direction (biarcs), but for corners, which stay. These curves
/// are within half the tolerance of the polygon. Where curves would cross, as in slits that are
/// narrower than the tolerance, they are finer, or lines.
///
/// @param tolerance  of the curves; sides of the polygons are within half of it of the outlines
///                   that they stand for, those of circles within all of it [m]
/// @throws Error(input) when the tolerance is not positive.
std::vector<CurvedRegion> curves_of(std::span<const Region> regions, double tolerance);

/// Returns a polygon whose vertices lie on the curves and whose sides are within `tolerance` of
/// them [m], in the sense of the ring.
std::vector<Vec2> polygon_within(const CurveRing& ring, double tolerance);

/// Returns the exact area of a region that curves bound [m^2].
double area(const CurvedRegion& region);
/// Returns the exact area of all of them [m^2].
double area(std::span<const CurvedRegion> regions);

}  // namespace flexmorph
