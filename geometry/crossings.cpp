#include "geometry/crossings.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>

namespace flexmorph {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_2;
using Segment = Kernel::Segment_2;
using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 2, std::size_t>;

bool cross(const Segment& s, const Segment& t) {
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) {
      if (s.vertex(i) != t.vertex(j)) continue;
      // Sides with a common end have different directions there, unless one lies on the other.
      const Point &common = s.vertex(i), &a = s.vertex(1 - i), &b = t.vertex(1 - j);
      return CGAL::collinear(a, common, b) &&
             !CGAL::collinear_are_strictly_ordered_along_line(a, common, b);
    }
  return CGAL::do_intersect(s, t);
}

}  // namespace

bool sides_cross(std::span<const Vec2> points,
                 std::span<const std::pair<std::size_t, std::size_t>> sides) {
  const auto point = [&](std::size_t i) { return Point(points[i].x(), points[i].y()); };
  std::vector<Segment> segments;
  std::vector<Box> boxes;
  for (const auto& [a, b] : sides) {
    segments.emplace_back(point(a), point(b));
    boxes.emplace_back(segments.back().bbox(), segments.size() - 1);
  }
  bool found = false;
  CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), [&](const Box& a, const Box& b) {
    found = found || cross(segments[a.info()], segments[b.info()]);
  });
  return found;
}

}  // namespace flexmorph
