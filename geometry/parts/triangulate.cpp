#include "geometry/parts/triangulate.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

namespace flexmorph {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
struct Point {
  int index = -1;  // index in the triangulation that is returned
};
using Vertices = CGAL::Triangulation_vertex_base_with_info_2<Point, Kernel>;
struct Patch {
  int index = -1;  // index of the set of faces that no edge of a ring separates
};
using Faces = CGAL::Constrained_triangulation_face_base_2<
    Kernel, CGAL::Triangulation_face_base_with_info_2<Patch, Kernel>>;
using Data = CGAL::Triangulation_data_structure_2<Vertices, Faces>;
// Outlines are computed exactly and then rounded to double. Rounding may make points coincide and
// edges cross, which this tag allows.
using Cdt = CGAL::Constrained_Delaunay_triangulation_2<Kernel, Data, CGAL::Exact_predicates_tag>;

void insert_ring(Cdt& cdt, const std::vector<Vec2>& ring, std::vector<Vec2>& points) {
  std::vector<Cdt::Vertex_handle> handles;
  for (const Vec2& p : ring) {
    const Cdt::Vertex_handle v = cdt.insert(Kernel::Point_2(p.x(), p.y()));
    v->info().index = static_cast<int>(points.size());
    points.push_back(p);
    handles.push_back(v);
  }
  for (std::size_t k = 0; k < handles.size(); ++k) {
    const Cdt::Vertex_handle a = handles[k], b = handles[(k + 1) % handles.size()];
    if (a != b) cdt.insert_constraint(a, b);
  }
}

/// Returns true if a point is inside, by the even-odd rule over all rings.
bool is_inside(const Region& region, const Vec2& p) {
  bool inside = false;
  const auto count = [&](const std::vector<Vec2>& ring) {
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
      if ((a.y() > p.y()) == (b.y() > p.y())) continue;
      if (p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) inside = !inside;
    }
  };
  count(region.outer);
  for (const auto& hole : region.holes) count(hole);
  return inside;
}

Vec2 middle_of(const Cdt::Face_handle& face) {
  Vec2 middle = Vec2::Zero();
  for (int k = 0; k < 3; ++k)
    middle += Vec2(face->vertex(k)->point().x(), face->vertex(k)->point().y()) / 3;
  return middle;
}

double area_of(const Cdt::Face_handle& face) {
  const auto &a = face->vertex(0)->point(), &b = face->vertex(1)->point(),
             &c = face->vertex(2)->point();
  return 0.5 * ((b.x() - a.x()) * (c.y() - a.y()) - (c.x() - a.x()) * (b.y() - a.y()));
}

/// Assigns the number `patch` to all faces that can be reached from `start` without crossing an
/// edge of a ring.
/// @returns the largest of these faces
Cdt::Face_handle mark_patch(const Cdt& cdt, const Cdt::Face_handle& start, int patch) {
  Cdt::Face_handle largest = start;
  std::vector<Cdt::Face_handle> waiting = {start};
  start->info().index = patch;
  while (!waiting.empty()) {
    const Cdt::Face_handle face = waiting.back();
    waiting.pop_back();
    if (area_of(face) > area_of(largest)) largest = face;
    for (int k = 0; k < 3; ++k) {
      const Cdt::Face_handle next = face->neighbor(k);
      if (face->is_constrained(k) || cdt.is_infinite(next) || next->info().index >= 0) continue;
      next->info().index = patch;
      waiting.push_back(next);
    }
  }
  return largest;
}

/// Returns for each patch if it is inside the region. The middle of its largest face is compared
/// with all rings; testing every face would take longer. Counting constraints from the outside
/// would fail, because rings that touch share constraints.
std::vector<bool> inside_patches(const Cdt& cdt, const Region& region) {
  std::vector<bool> inside;
  for (const Cdt::Face_handle face : cdt.finite_face_handles())
    if (face->info().index < 0)
      inside.push_back(
          is_inside(region, middle_of(mark_patch(cdt, face, static_cast<int>(inside.size())))));
  return inside;
}

}  // namespace

Triangulation triangulate(const Region& region) {
  Triangulation out;
  Cdt cdt;
  insert_ring(cdt, region.outer, out.points);
  for (const auto& hole : region.holes) insert_ring(cdt, hole, out.points);
  for (const Cdt::Vertex_handle v : cdt.finite_vertex_handles()) {
    if (v->info().index >= 0) continue;  // new points are intersections of edges
    v->info().index = static_cast<int>(out.points.size());
    out.points.emplace_back(v->point().x(), v->point().y());
  }
  const std::vector<bool> inside = inside_patches(cdt, region);
  for (const Cdt::Face_handle face : cdt.finite_face_handles()) {
    if (!inside[static_cast<std::size_t>(face->info().index)]) continue;
    std::array<int, 3> corners{};
    for (int k = 0; k < 3; ++k)
      corners[static_cast<std::size_t>(k)] = face->vertex(k)->info().index;
    out.triangles.push_back(corners);
  }
  if (out.triangles.empty()) throw Error::numerical("triangulate: the region has no area");
  return out;
}

}  // namespace flexmorph
