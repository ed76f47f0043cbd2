#include "geometry/triangulate.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <deque>

namespace flexmorph {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
struct Face {
  int depth = -1;  // rings between the face and infinity
};
using Vertices = CGAL::Triangulation_vertex_base_with_info_2<int, Kernel>;
using Faces = CGAL::Constrained_triangulation_face_base_2<
    Kernel, CGAL::Triangulation_face_base_with_info_2<Face, Kernel>>;
using Data = CGAL::Triangulation_data_structure_2<Vertices, Faces>;
using Cdt =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel, Data, CGAL::No_constraint_intersection_tag>;

void insert_ring(Cdt& cdt, const std::vector<Vec2>& ring, std::vector<Vec2>& points) {
  std::vector<Cdt::Vertex_handle> handles;
  for (const Vec2& p : ring) {
    const Cdt::Vertex_handle v = cdt.insert(Kernel::Point_2(p.x(), p.y()));
    v->info() = static_cast<int>(points.size());
    points.push_back(p);
    handles.push_back(v);
  }
  for (std::size_t k = 0; k < handles.size(); ++k)
    cdt.insert_constraint(handles[k], handles[(k + 1) % handles.size()]);
}

/// Counts the rings between every face and infinity: odd faces are material.
void mark_depths(Cdt& cdt) {
  std::deque<std::pair<Cdt::Face_handle, int>> front = {{cdt.infinite_face(), 0}};
  while (!front.empty()) {
    const auto [seed, depth] = front.front();
    front.pop_front();
    std::vector<Cdt::Face_handle> stack = {seed};
    while (!stack.empty()) {
      const Cdt::Face_handle face = stack.back();
      stack.pop_back();
      if (face->info().depth >= 0) continue;
      face->info().depth = depth;
      for (int k = 0; k < 3; ++k) {
        const Cdt::Face_handle next = face->neighbor(k);
        if (next->info().depth >= 0) continue;
        if (cdt.is_constrained({face, k}))
          front.emplace_back(next, depth + 1);
        else
          stack.push_back(next);
      }
    }
  }
}

}  // namespace

Triangulation triangulate(const Region& region) {
  Triangulation out;
  Cdt cdt;
  try {
    insert_ring(cdt, region.outer, out.points);
    for (const auto& hole : region.holes) insert_ring(cdt, hole, out.points);
  } catch (const Cdt::Intersection_of_constraints_exception&) {
    throw Error::numerical("triangulate: rings of the region cross");
  }
  mark_depths(cdt);
  for (const Cdt::Face_handle face : cdt.finite_face_handles()) {
    if (face->info().depth % 2 == 0) continue;
    out.triangles.push_back(
        {face->vertex(0)->info(), face->vertex(1)->info(), face->vertex(2)->info()});
  }
  if (out.triangles.empty()) throw Error::numerical("triangulate: the region has no area");
  return out;
}

}  // namespace flexmorph
