#include "geometry/parts/part_mesh.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_mesh_face_base_2.h>
#include <CGAL/Delaunay_mesh_vertex_base_2.h>
#include <CGAL/Delaunay_mesher_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include "geometry/parts/conforming_rings.h"

namespace flexmorph {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Vertices =
    CGAL::Triangulation_vertex_base_with_info_2<int, Kernel,
                                                CGAL::Delaunay_mesh_vertex_base_2<Kernel>>;
using Faces = CGAL::Delaunay_mesh_face_base_2<
    Kernel, CGAL::Constrained_Delaunay_triangulation_face_base_2<
                Kernel, CGAL::Constrained_triangulation_face_base_2<
                            Kernel, CGAL::Triangulation_face_base_with_info_2<int, Kernel>>>>;
using Data = CGAL::Triangulation_data_structure_2<Vertices, Faces>;
// Edges of outlines that were rounded to doubles may cross by round-off, which this tag allows.
using Cdt = CGAL::Constrained_Delaunay_triangulation_2<Kernel, Data, CGAL::Exact_predicates_tag>;

Vec2 location_of(const Cdt::Vertex_handle& v) { return {v->point().x(), v->point().y()}; }

/// The order in which triangles are refined: too large ones first, then those with a small angle.
struct Criteria {
  /// Square of the sine of the smallest angle (20.7 degrees), for which the refinement terminates.
  static constexpr double kSine = 0.125;

  struct Quality {
    double sine = 1, size = 0;
    bool operator<(const Quality& other) const {
      const bool large = size > 1, other_large = other.size > 1;
      if (large != other_large) return large;
      return large ? size > other.size : sine < other.sine;
    }
  };

  struct Is_bad {
    const SizeField* sizes = nullptr;

    CGAL::Mesh_2::Face_badness operator()(const Quality& q) const {
      if (q.size > 1) return CGAL::Mesh_2::IMPERATIVELY_BAD;
      return q.sine < kSine ? CGAL::Mesh_2::BAD : CGAL::Mesh_2::NOT_BAD;
    }
    CGAL::Mesh_2::Face_badness operator()(const Cdt::Face_handle& face, Quality& q) const {
      const Vec2 a = location_of(face->vertex(0)), b = location_of(face->vertex(1)),
                 c = location_of(face->vertex(2));
      std::array<double, 3> sides = {(b - a).squaredNorm(), (c - b).squaredNorm(),
                                     (a - c).squaredNorm()};
      std::sort(sides.begin(), sides.end());
      const double wanted =
          std::min({sizes->at((a + b + c) / 3), sizes->at(a), sizes->at(b), sizes->at(c)});
      q.size = sides[2] / (wanted * wanted);
      const Vec2 u = b - a, v = c - a;
      const double twice = u.x() * v.y() - u.y() * v.x();
      q.sine = twice * twice / (sides[2] * sides[1]);
      return (*this)(q);
    }
  };

  const SizeField* sizes = nullptr;
  Is_bad is_bad_object() const { return {sizes}; }
};

/// Limit on the number of steps, far above the number that any mesh that fits into memory needs.
constexpr long kMaxSteps = 1'000'000;

using Mesher = CGAL::Delaunay_mesher_2<Cdt, Criteria>;

/// The triangulation of one region in its current state of refinement.
struct Piece {
  Cdt cdt;
  // one point in every inner face of the arrangement of constraints
  std::vector<Kernel::Point_2> seeds;
  std::optional<Mesher> mesher;

  /// @param lines  as conforming_lines() returns them
  Piece(const Region& region, std::span<const Segment> lines) {
    insert_ring(region.outer);
    for (const auto& hole : region.holes) insert_ring(hole);
    for (const Segment& s : lines)
      if (s.a != s.b && (s.a.x() == s.b.x() || s.a.y() == s.b.y()))
        cdt.insert_constraint(Kernel::Point_2(s.a.x(), s.a.y()), Kernel::Point_2(s.b.x(), s.b.y()));
    find_seeds(region);
  }
  Piece(const Piece&) = delete;
  Piece& operator=(const Piece&) = delete;

  void refine(const SizeField& sizes) {
    if (mesher) {
      mesher->set_criteria(Criteria{&sizes});
    } else {
      mesher.emplace(cdt, Criteria{&sizes});
      mesher->set_seeds(seeds.begin(), seeds.end(), true);
      mesher->init();
    }
    for (long step = 0; !mesher->is_refinement_done(); ++step) {
      if (step == kMaxSteps)
        throw Error::numerical("mesh of a part: the refinement did not end after " +
                               std::to_string(step) + " points");
      mesher->step_by_step_refine_mesh();
    }
  }

 private:
  void insert_ring(const std::vector<Vec2>& ring) {
    std::vector<Cdt::Vertex_handle> handles;
    for (const Vec2& p : ring) handles.push_back(cdt.insert(Kernel::Point_2(p.x(), p.y())));
    for (std::size_t k = 0; k < handles.size(); ++k) {
      const Cdt::Vertex_handle a = handles[k], b = handles[(k + 1) % handles.size()];
      if (a != b) cdt.insert_constraint(a, b);
    }
  }

  /// Finds a point in every patch between constraints that is inside the region. The test uses the
  /// middle of the largest face of the patch.
  void find_seeds(const Region& region) {
    for (const Cdt::Face_handle face : cdt.finite_face_handles()) face->info() = 0;
    for (const Cdt::Face_handle start : cdt.finite_face_handles()) {
      if (start->info() != 0) continue;
      const Vec2 middle = middle_of_largest(start);
      if (contains(region, middle)) seeds.emplace_back(middle.x(), middle.y());
    }
  }
  Vec2 middle_of_largest(const Cdt::Face_handle& start) const {
    std::vector<Cdt::Face_handle> waiting = {start};
    start->info() = 1;
    double largest = -1;
    Vec2 out = Vec2::Zero();
    while (!waiting.empty()) {
      const Cdt::Face_handle face = waiting.back();
      waiting.pop_back();
      const Vec2 a = location_of(face->vertex(0)), b = location_of(face->vertex(1)),
                 c = location_of(face->vertex(2));
      const double twice = (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
      if (twice > largest) {
        largest = twice;
        out = (a + b + c) / 3;
      }
      for (int k = 0; k < 3; ++k) {
        const Cdt::Face_handle next = face->neighbor(k);
        if (face->is_constrained(k) || cdt.is_infinite(next) || next->info() != 0) continue;
        next->info() = 1;
        waiting.push_back(next);
      }
    }
    return out;
  }
};

/// Adds the triangles of regions to a mesh. Nodes are numbered in the order in which they occur.
class Collector {
 public:
  void add(Piece& piece) {
    Cdt& cdt = piece.cdt;
    for (const Cdt::Vertex_handle v : cdt.finite_vertex_handles()) v->info() = -1;
    for (const Cdt::Face_handle f : cdt.finite_face_handles()) f->info() = -1;
    for (const Cdt::Face_handle f : cdt.finite_face_handles())
      if (f->is_in_domain() && f->info() < 0) add_patch(cdt, f);
  }
  /// Appends the middles of sides after all corners and returns the mesh.
  PartMesh finish() && {
    mesh_.n_corners = static_cast<int>(mesh_.points.size());
    std::map<std::pair<int, int>, int> middles;
    for (auto& t : mesh_.triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        const int a = t[k], b = t[(k + 1) % 3];
        const auto [at, fresh] =
            middles.try_emplace(std::minmax(a, b), static_cast<int>(mesh_.points.size()));
        if (fresh) mesh_.points.push_back(0.5 * (mesh_.point(a) + mesh_.point(b)));
        t[3 + k] = at->second;
      }
    return std::move(mesh_);
  }

 private:
  void add_patch(const Cdt& cdt, const Cdt::Face_handle& start) {
    std::vector<Cdt::Face_handle> waiting = {start};
    start->info() = 1;
    while (!waiting.empty()) {
      const Cdt::Face_handle face = waiting.back();
      waiting.pop_back();
      std::array<int, 6> nodes{};
      for (int k = 0; k < 3; ++k) {
        const Cdt::Vertex_handle v = face->vertex(k);
        if (v->info() < 0) {
          v->info() = static_cast<int>(mesh_.points.size());
          mesh_.points.push_back(location_of(v));
        }
        nodes[static_cast<std::size_t>(k)] = v->info();
      }
      mesh_.triangles.push_back(nodes);
      mesh_.piece.push_back(mesh_.n_connected_regions);
      for (int k = 0; k < 3; ++k) {
        const Cdt::Face_handle next = face->neighbor(k);
        if (cdt.is_infinite(next) || !next->is_in_domain() || next->info() >= 0) continue;
        next->info() = 1;
        waiting.push_back(next);
      }
    }
    ++mesh_.n_connected_regions;
  }

  PartMesh mesh_;
};

}  // namespace

struct PartMesher::Impl {
  std::vector<std::unique_ptr<Piece>> pieces;
};

PartMesher::PartMesher(std::span<const Region> regions, std::span<const Segment> lines)
    : impl_(std::make_unique<Impl>()) {
  const double small = smallest_distance(regions);
  const std::vector<Segment> cut = conforming_lines(lines, small);
  for (const Region& region : regions) {
    const Region conforming = with_points_of(region, cut, small);
    if (conforming.outer.size() < 3) continue;
    auto piece = std::make_unique<Piece>(conforming, cut);
    if (!piece->seeds.empty()) impl_->pieces.push_back(std::move(piece));
  }
  if (impl_->pieces.empty()) throw Error::numerical("mesh of a part: the part has no area");
}
PartMesher::~PartMesher() = default;
PartMesher::PartMesher(PartMesher&&) noexcept = default;

void PartMesher::refine(const SizeField& size) {
  for (auto& piece : impl_->pieces) piece->refine(size);
}

PartMesh PartMesher::mesh() const {
  Collector all;
  for (const auto& piece : impl_->pieces) all.add(*piece);
  return std::move(all).finish();
}

std::array<Vec2, 3> PartMesh::corners(std::size_t triangle) const {
  const auto& t = triangles[triangle];
  return {point(t[0]), point(t[1]), point(t[2])};
}

double PartMesh::area() const {
  double twice = 0;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto [a, b, c] = corners(t);
    twice += (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
  }
  return 0.5 * twice;
}

std::vector<Vec2> reentrant_corners(std::span<const Region> regions, double angle) {
  std::vector<Vec2> out;
  const auto look = [&](const std::vector<Vec2>& ring) {
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const Vec2 &before = ring[(k + ring.size() - 1) % ring.size()], &at = ring[k],
                 &after = ring[(k + 1) % ring.size()];
      const Vec2 u = at - before, v = after - at;
      // Material lies on the left, therefore the inner angle at a turn to the right is larger than
      // 180 degrees.
      const double turn = std::atan2(u.x() * v.y() - u.y() * v.x(), u.dot(v));
      if (std::numbers::pi - turn > angle) out.push_back(at);
    }
  };
  for (const Region& r : regions) {
    look(r.outer);
    for (const auto& hole : r.holes) look(hole);
  }
  return out;
}

}  // namespace flexmorph
