#include "geometry/triangulate.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

namespace flexmorph {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
struct Point {
  int index = -1;  // in the triangulation that is returned
};
using Vertices = CGAL::Triangulation_vertex_base_with_info_2<Point, Kernel>;
using Faces = CGAL::Constrained_triangulation_face_base_2<Kernel>;
using Data = CGAL::Triangulation_data_structure_2<Vertices, Faces>;
// Outlines are exact before they are rounded to doubles: after that, points may coincide and edges
// cross by round-off, which this tag allows.
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

/// Even-odd rule over all rings.
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

}  // namespace

Triangulation triangulate(const Region& region) {
  Triangulation out;
  Cdt cdt;
  insert_ring(cdt, region.outer, out.points);
  for (const auto& hole : region.holes) insert_ring(cdt, hole, out.points);
  for (const Cdt::Vertex_handle v : cdt.finite_vertex_handles()) {
    if (v->info().index >= 0) continue;  // else where edges cross
    v->info().index = static_cast<int>(out.points.size());
    out.points.emplace_back(v->point().x(), v->point().y());
  }
  for (const Cdt::Face_handle face : cdt.finite_face_handles()) {
    std::array<int, 3> corners{};
    Vec2 middle = Vec2::Zero();
    for (int k = 0; k < 3; ++k) {
      corners[static_cast<std::size_t>(k)] = face->vertex(k)->info().index;
      middle += Vec2(face->vertex(k)->point().x(), face->vertex(k)->point().y()) / 3;
    }
    // Not by counting constraints on the way from outside: rings that touch share some.
    if (is_inside(region, middle)) out.triangles.push_back(corners);
  }
  if (out.triangles.empty()) throw Error::numerical("triangulate: the region has no area");
  return out;
}

}  // namespace flexmorph
