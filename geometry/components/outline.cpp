#include "geometry/components/outline.h"

#include <CGAL/Boolean_set_operations_2.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_2.h>
#include <CGAL/Polygon_2_algorithms.h>
#include <CGAL/Polygon_set_2.h>
#include <CGAL/Polygon_with_holes_2.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "geometry/ring_area.h"

namespace flexmorph {

namespace {

using Exact = CGAL::Exact_predicates_exact_constructions_kernel;
using Inexact = CGAL::Exact_predicates_inexact_constructions_kernel;
using Polygon = CGAL::Polygon_2<Exact>;
using PolygonWithHoles = CGAL::Polygon_with_holes_2<Exact>;

// The interval arithmetic of CGAL overflows if a product of four coordinates does, and then its
// sweep crashes.
constexpr double kMaxCoordinate = 1e60;

/// Returns a counterclockwise polygon; `number` is its index in the list, for the message.
Polygon exact_polygon(const std::vector<Vec2>& vertices, std::size_t number) {
  const auto refuse = [&](const char* why) {
    throw Error::numerical("unite: polygon " + std::to_string(number) + " of " +
                           std::to_string(vertices.size()) + " vertices " + why);
  };
  Polygon polygon;
  for (const Vec2& v : vertices) {
    if (!v.allFinite()) refuse("has a coordinate that is not finite");
    if (!(v.cwiseAbs().maxCoeff() < kMaxCoordinate)) refuse("has a coordinate of 1e60 or more");
    polygon.push_back(Exact::Point_2(v.x(), v.y()));
  }
  if (polygon.size() < 3 || !polygon.is_simple())
    refuse("has fewer than 3 vertices, or crosses or touches itself");
  if (polygon.orientation() == CGAL::COLLINEAR) refuse("has no area");
  if (polygon.orientation() == CGAL::CLOCKWISE) polygon.reverse_orientation();
  return polygon;
}

std::vector<Vec2> rounded(const Polygon& polygon) {
  std::vector<Vec2> vertices;
  vertices.reserve(polygon.size());
  for (auto v = polygon.vertices_begin(); v != polygon.vertices_end(); ++v) {
    vertices.emplace_back(CGAL::to_double(v->x()), CGAL::to_double(v->y()));
  }
  return vertices;
}

CGAL::Bounded_side side_of(const std::vector<Vec2>& ring, const Vec2& point) {
  std::vector<Inexact::Point_2> vertices;
  vertices.reserve(ring.size());
  for (const Vec2& v : ring) vertices.emplace_back(v.x(), v.y());
  return CGAL::bounded_side_2(vertices.begin(), vertices.end(),
                              Inexact::Point_2(point.x(), point.y()), Inexact());
}

}  // namespace

double signed_area(const std::vector<Vec2>& ring) {
  double twice = 0;
  for (std::size_t k = 1; k + 1 < ring.size(); ++k) {
    const Vec2 a = ring[k] - ring[0], b = ring[k + 1] - ring[0];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * twice;
}

std::vector<Region> unite(std::span<const std::vector<Vec2>> polygons, const Box& clip) {
  if (!((clip.upper - clip.lower).minCoeff() > 0)) {
    throw Error::input("unite: the box for clipping is empty");
  }
  return unite(polygons, {corners_of(clip), {}}, {});
}

std::vector<Region> unite(std::span<const std::vector<Vec2>> polygons, const Region& domain,
                          std::span<const std::vector<Vec2>> voids) {
  std::vector<Polygon> exact;
  exact.reserve(polygons.size());
  for (std::size_t k = 0; k < polygons.size(); ++k) {
    exact.push_back(exact_polygon(polygons[k], k));
  }
  CGAL::Polygon_set_2<Exact> set;
  set.join(exact.begin(), exact.end());
  std::size_t number = polygons.size();
  set.intersection(exact_polygon(domain.outer, number++));
  for (const auto& hole : domain.holes) set.difference(exact_polygon(hole, number++));
  for (const auto& hole : voids) set.difference(exact_polygon(hole, number++));

  std::vector<PolygonWithHoles> pieces;
  set.polygons_with_holes(std::back_inserter(pieces));
  std::vector<Region> regions;
  regions.reserve(pieces.size());
  for (const PolygonWithHoles& piece : pieces) {
    Region region{rounded(piece.outer_boundary()), {}};
    for (auto h = piece.holes_begin(); h != piece.holes_end(); ++h) {
      region.holes.push_back(rounded(*h));
    }
    regions.push_back(std::move(region));
  }
  return regions;
}

std::vector<std::vector<Vec2>> rings_of(const Region& region) {
  std::vector<std::vector<Vec2>> rings = {region.outer};
  rings.insert(rings.end(), region.holes.begin(), region.holes.end());
  return rings;
}

Region region_of(std::vector<std::vector<Vec2>> rings) {
  if (rings.empty()) throw Error::input("an outline must have at least one ring");
  const auto larger = [](const auto& a, const auto& b) {
    return std::abs(signed_area(a)) > std::abs(signed_area(b));
  };
  std::stable_sort(rings.begin(), rings.end(), larger);
  Region out;
  double left = 2 * std::abs(signed_area(rings[0]));
  for (auto& ring : rings) {
    try {
      exact_polygon(ring, 0);
    } catch (const Error&) {
      const Vec2& at = ring.front();
      throw Error::input("the ring that begins at (" + std::to_string(at.x()) + ", " +
                         std::to_string(at.y()) + ") m crosses or touches itself");
    }
    const double size = signed_area(ring);
    left -= std::abs(size);
    const bool outer = out.outer.empty();
    if ((size > 0) != outer) std::reverse(ring.begin(), ring.end());
    if (outer) {
      out.outer = std::move(ring);
    } else {
      out.holes.push_back(std::move(ring));
    }
  }
  // Holes that are not inside, or that overlap, would remove another area than their sum.
  const std::vector<Region> united = unite({&out.outer, 1}, {out.outer, {}}, out.holes);
  const bool apart = united.size() == 1 && united[0].holes.size() == out.holes.size() &&
                     std::abs(area(united) - left) <= 1e-9 * area({out.outer, {}});
  if (!apart)
    throw Error::input(
        "an outline is one outer ring with separate holes inside it; these rings cross or touch, "
        "or a hole lies outside");
  return out;
}

std::vector<Vec2> corners_of(const Box& box) {
  const Vec2 &a = box.lower, &b = box.upper;
  return {a, {b.x(), a.y()}, b, {a.x(), b.y()}};
}

Box bounds_of(std::span<const Vec2> points) {
  Box box{points.front(), points.front()};
  for (const Vec2& p : points) {
    box.lower = box.lower.cwiseMin(p);
    box.upper = box.upper.cwiseMax(p);
  }
  return box;
}

std::vector<Vec2> circle_within(const Vec2& center, double radius, double tolerance) {
  if (!(radius > 0 && tolerance > 0))
    throw Error::input("circle: the radius and the tolerance must be positive");
  constexpr double kMinPoints = 8, kMaxPoints = 1 << 16;
  // The middle of a side lies r (1 - cos(π/n)) = 2 r sin²(π/2n) inside the circle.
  const double half = std::asin(std::min(1.0, std::sqrt(0.5 * tolerance / radius)));
  const int n = static_cast<int>(
      std::clamp(std::ceil(0.5 * std::numbers::pi / half), kMinPoints, kMaxPoints));
  std::vector<Vec2> ring;
  for (int k = 0; k < n; ++k) {
    const double angle = 2 * std::numbers::pi * k / n;
    ring.emplace_back(center + radius * Vec2(std::cos(angle), std::sin(angle)));
  }
  return ring;
}

std::vector<Vec2> outline_within(const Component& c, double min_half_thickness, double tolerance) {
  if (!(tolerance > 0)) throw Error::input("outline: the tolerance must be positive");
  constexpr int kMinPoints = 32, kMaxPoints = 1 << 16;
  std::vector<Vec2> coarse = outline(c, min_half_thickness, kMinPoints);
  for (int n = kMinPoints; n < kMaxPoints; n *= 2) {
    std::vector<Vec2> fine = outline(c, min_half_thickness, 2 * n);
    // The distance of the vertices of the finer polygon from the sides estimates the error of the
    // coarse one.
    double off = 0;
    for (std::size_t k = 0; k < coarse.size(); ++k) {
      const Vec2 a = coarse[k], side = coarse[(k + 1) % coarse.size()] - a;
      const Vec2 to = fine[2 * k + 1] - a;
      off = std::max(off, std::abs(side.x() * to.y() - side.y() * to.x()) / side.norm());
    }
    if (off <= tolerance) return coarse;
    coarse = std::move(fine);
  }
  return coarse;
}

double area(const Region& r) {
  double sum = signed_area(r.outer);
  for (const auto& hole : r.holes) sum += signed_area(hole);
  return sum;
}

double area(std::span<const Region> regions) {
  double sum = 0;
  for (const Region& r : regions) sum += area(r);
  return sum;
}

bool contains(const Region& r, const Vec2& point) {
  if (r.outer.empty() || side_of(r.outer, point) == CGAL::ON_UNBOUNDED_SIDE) return false;
  return std::none_of(r.holes.begin(), r.holes.end(), [&](const auto& hole) {
    return side_of(hole, point) == CGAL::ON_BOUNDED_SIDE;
  });
}

}  // namespace flexmorph
