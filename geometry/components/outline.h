#pragma once

#include <span>
#include <vector>

#include "geometry/components/component.h"

namespace flexmorph {

/// A polygon with holes: the outer ring is counterclockwise, holes are clockwise [m].
struct Region {
  std::vector<Vec2> outer;
  std::vector<std::vector<Vec2>> holes;
};

/// Exact union (CGAL, exact predicates and constructions) of polygons, clipped to the box of the
/// grid's domain. One Region per connected piece.
///
/// Polygons may be given in either sense of rotation. Vertices of the result are exact inside and
/// rounded to double on the way out. Pieces that share no more than a vertex stay apart.
/// @throws Error(numerical) when a polygon is not simple, has no area or is not finite;
///         Error(input) when the box is empty.
std::vector<Region> unite(std::span<const std::vector<Vec2>> polygons, const Box& clip);
/// The same, clipped to a domain with or without holes, with voids taken out.
std::vector<Region> unite(std::span<const std::vector<Vec2>> polygons, const Region& domain,
                          std::span<const std::vector<Vec2>> voids);

/// One ring and its holes, in any order and sense.
/// @throws Error(input) when there is none, a ring crosses itself, or they are not one outer ring
///         and holes within it that keep apart.
Region region_of(std::vector<std::vector<Vec2>> rings);

/// All rings of a region, the outer one first.
std::vector<std::vector<Vec2>> rings_of(const Region& region);

/// Corners of a box, counterclockwise.
std::vector<Vec2> corners_of(const Box& box);

/// The smallest box that holds points, one or more of them.
Box bounds_of(std::span<const Vec2> points);

/// A circle as a polygon whose vertices lie on it and whose sides stay within `tolerance` of it
/// [m], counterclockwise.
/// @throws Error(input) when radius or tolerance is not positive.
std::vector<Vec2> circle_within(const Vec2& center, double radius, double tolerance);

/// Outline of a component as a polygon whose vertices lie on it and whose sides stay within
/// `tolerance` of it [m], counterclockwise.
/// @throws Error(input) when the tolerance is not positive.
std::vector<Vec2> outline_within(const Component& c, double min_half_thickness, double tolerance);

double area(const Region& r);  ///< [m^2]
double area(std::span<const Region> r);

/// Is the point inside or on the boundary of the region?
bool contains(const Region& r, const Vec2& point);

}  // namespace flexmorph
