#pragma once

#include <span>
#include <vector>

#include "geometry/components/component.h"

namespace flexmorph {

/// A polygon with holes: the outer ring is counterclockwise, holes are clockwise [m].
struct Region {
  std::vector<Vec2> outer;               ///< Outer ring, counterclockwise [m].
  std::vector<std::vector<Vec2>> holes;  ///< Rings of the holes, clockwise [m].
};

/// Returns the union of polygons, clipped to a box: one region per connected region of the union.
/// The union is exact (CGAL, exact predicates and constructions).
///
/// Polygons may be given in either sense of rotation. Vertices of the result are computed exactly
/// and rounded to double at the end. Connected regions that share only a vertex are separate
/// regions.
/// @throws Error (numerical) when a polygon is not simple, has no area or is not finite; Error
///         (input) when the box is empty.
std::vector<Region> unite(std::span<const std::vector<Vec2>> polygons, const Box& clip);
/// Returns the union of polygons, clipped to a domain with or without holes, without the polygons
/// `voids`. It has the properties described for unite() with a box.
std::vector<Region> unite(std::span<const std::vector<Vec2>> polygons, const Region& domain,
                          std::span<const std::vector<Vec2>> voids);

/// Returns the region that one ring and its holes bound. The rings may have any order and sense.
/// @throws Error (input) when there is no ring, when a ring crosses itself, or when the rings are
///         not one outer ring with holes inside that do not touch each other.
Region region_of(std::vector<std::vector<Vec2>> rings);

/// Returns all rings of a region, the outer one first.
std::vector<std::vector<Vec2>> rings_of(const Region& region);

/// Returns the corners of a box, counterclockwise.
std::vector<Vec2> corners_of(const Box& box);

/// Returns the smallest box that contains one or more points.
Box bounds_of(std::span<const Vec2> points);

/// Returns a circle as a counterclockwise polygon [m]. Its vertices lie on the circle, and its
/// sides are within `tolerance` of the circle.
/// @throws Error (input) when radius or tolerance is not positive.
std::vector<Vec2> circle_within(const Vec2& center, double radius, double tolerance);

/// Returns the outline of a component as a counterclockwise polygon [m]. Its vertices lie on the
/// outline, and its sides are within `tolerance` of the outline.
/// @throws Error (input) when the tolerance is not positive.
std::vector<Vec2> outline_within(const Component& c, double min_half_thickness, double tolerance);

/// Returns the area of a region without its holes [m^2].
double area(const Region& r);
/// Returns the sum of the areas of regions [m^2].
double area(std::span<const Region> r);

/// Returns true if a point is inside or on the boundary of a region.
bool contains(const Region& r, const Vec2& point);

}  // namespace flexmorph
