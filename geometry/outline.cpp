#include "geometry/outline.h"

#include <CGAL/Boolean_set_operations_2.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_2.h>
#include <CGAL/Polygon_2_algorithms.h>
#include <CGAL/Polygon_set_2.h>
#include <CGAL/Polygon_with_holes_2.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include "geometry/component_frame.h"

namespace flexmorph {

namespace {

using Exact = CGAL::Exact_predicates_exact_constructions_kernel;
using Inexact = CGAL::Exact_predicates_inexact_constructions_kernel;
using Polygon = CGAL::Polygon_2<Exact>;
using PolygonWithHoles = CGAL::Polygon_with_holes_2<Exact>;

/// Counterclockwise polygon; `number` is its place in the list, for the message.
Polygon exact_polygon(const std::vector<Vec2>& vertices, std::size_t number) {
  const auto refuse = [&](const char* why) {
    throw Error::numerical("unite: polygon " + std::to_string(number) + " of " +
                           std::to_string(vertices.size()) + " vertices " + why);
  };
  Polygon polygon;
  for (const Vec2& v : vertices) {
    if (!v.allFinite()) refuse("is not finite");
    polygon.push_back(Exact::Point_2(v.x(), v.y()));
  }
  if (polygon.size() < 3 || !polygon.is_simple()) refuse("is not simple");
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

/// Shoelace sum about the first vertex, positive counterclockwise   [m^2].
double signed_area(const std::vector<Vec2>& ring) {
  double twice = 0;
  for (std::size_t k = 1; k + 1 < ring.size(); ++k) {
    const Vec2 a = ring[k] - ring[0], b = ring[k + 1] - ring[0];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * twice;
}

CGAL::Bounded_side side_of(const std::vector<Vec2>& ring, const Vec2& point) {
  std::vector<Inexact::Point_2> vertices;
  vertices.reserve(ring.size());
  for (const Vec2& v : ring) vertices.emplace_back(v.x(), v.y());
  return CGAL::bounded_side_2(vertices.begin(), vertices.end(),
                              Inexact::Point_2(point.x(), point.y()), Inexact());
}

/// One component as the sampling sees it.
struct Stencil {
  ComponentFrame frame;
  Box local;           ///< rectangle of the component's frame around the outline
  double left, right;  ///< its extent along X
};

std::vector<Stencil> stencils(std::span<const Component> components, double min_half_thickness) {
  std::vector<Stencil> all;
  all.reserve(components.size());
  for (const Component& c : components) {
    const ComponentFrame frame(c, min_half_thickness);
    const Vec2 half(c.half_length, frame.largest_half_thickness());
    const Box local{-half, half}, box = frame.enclosing(local);
    all.push_back({frame, local, box.lower.x(), box.upper.x()});
  }
  return all;
}

/// The samples of one column, from below: 1 where there is material.
class SampleColumn {
 public:
  SampleColumn(double y0, double step, int count)
      : y0_(y0), step_(step), count_(count), covered_(static_cast<std::size_t>(count)) {}

  void clear() { std::fill(covered_.begin(), covered_.end(), std::uint8_t{0}); }

  void cover(const Stencil& stencil, double X) {
    const IndexRange rows = indices_in(stencil.frame.column(X, stencil.local), y0_, step_, count_);
    const ComponentFrame frame = stencil.frame;  // a copy: bytes written may alias anything else
    const double y0 = y0_, step = step_;
    std::uint8_t* covered = covered_.data();
    for (int k = rows.first; k < rows.end; ++k) {
      const double Y = y0 + k * step;
      const double x = frame.x(X, Y), u = x * frame.per_length();
      const double v = frame.y(X, Y) / frame.half_thickness(x);
      const double u2 = u * u, v2 = v * v;
      covered[k] |= u2 * u2 * u2 + v2 * v2 * v2 <= 1 ? 1 : 0;
    }
  }

  void fill(std::span<const Box> boxes, double X, std::uint8_t value) {
    for (const Box& box : boxes) {
      if (X < box.lower.x() || X > box.upper.x()) continue;
      const IndexRange rows = indices_in({box.lower.y(), box.upper.y()}, y0_, step_, count_);
      std::fill(covered_.begin() + rows.first, covered_.begin() + rows.end, value);
    }
  }

  /// Adds the samples of every cell to counts; `samples` of them to a cell.
  void add_to(double* counts, int samples) const {
    const std::uint8_t* covered = covered_.data();
    for (int k = 0; k < count_; k += samples, ++counts) {
      int sum = 0;
      for (int l = 0; l < samples; ++l) sum += covered[k + l];
      *counts += sum;
    }
  }

 private:
  double y0_, step_;
  int count_;
  std::vector<std::uint8_t> covered_;
};

/// Pieces of material joined over edges, found one by one.
class Pieces {
 public:
  Pieces(const Grid& grid, const VectorXd& fractions)
      : grid_(grid), open_(static_cast<std::size_t>(grid.n_cells())) {
    for (int c = 0; c < grid.n_cells(); ++c) open_[c] = fractions[c] >= 0.5;
  }

  bool is_open(int i, int j) const { return open_[grid_.cell(i, j)]; }

  struct Piece {
    int cells = 0;
    bool spans = false;  ///< touches the first and the last column
  };
  Piece take(int i, int j) {
    bool first = false, last = false;
    Piece piece;
    enter(i, j);
    while (!front_.empty()) {
      const int cell = front_.back();
      front_.pop_back();
      const int column = cell / grid_.ny, row = cell % grid_.ny;
      ++piece.cells;
      first = first || column == 0;
      last = last || column == grid_.nx - 1;
      if (column > 0) enter(column - 1, row);
      if (column < grid_.nx - 1) enter(column + 1, row);
      if (row > 0) enter(column, row - 1);
      if (row < grid_.ny - 1) enter(column, row + 1);
    }
    piece.spans = first && last;
    return piece;
  }

 private:
  void enter(int i, int j) {
    const int cell = grid_.cell(i, j);
    if (!open_[cell]) return;
    open_[cell] = false;
    front_.push_back(cell);
  }

  const Grid& grid_;
  std::vector<bool> open_;
  std::vector<int> front_;
};

}  // namespace

std::vector<Region> unite(std::span<const std::vector<Vec2>> polygons, const Box& clip) {
  if (!((clip.upper - clip.lower).minCoeff() > 0)) {
    throw Error::input("unite: the box to clip to is empty");
  }
  std::vector<Polygon> exact;
  exact.reserve(polygons.size());
  for (std::size_t k = 0; k < polygons.size(); ++k) {
    exact.push_back(exact_polygon(polygons[k], k));
  }
  CGAL::Polygon_set_2<Exact> set;
  set.join(exact.begin(), exact.end());
  Polygon window;
  for (const auto& [x, y] : {std::pair{clip.lower.x(), clip.lower.y()},
                             {clip.upper.x(), clip.lower.y()},
                             {clip.upper.x(), clip.upper.y()},
                             {clip.lower.x(), clip.upper.y()}}) {
    window.push_back(Exact::Point_2(x, y));
  }
  set.intersection(window);

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

VectorXd area_fractions(const Grid& grid, std::span<const Component> components,
                        double min_half_thickness, std::span<const Box> solid,
                        std::span<const Box> empty, int samples) {
  if (samples < 1) {
    throw Error::input("area_fractions: samples = " + std::to_string(samples) +
                       ": at least one to a cell is needed");
  }
  const std::vector<Stencil> all = stencils(components, min_half_thickness);
  const double dx = grid.dx() / samples, dy = grid.dy() / samples;
  SampleColumn column(grid.y0 + 0.5 * dy, dy, grid.ny * samples);
  VectorXd fractions = VectorXd::Zero(grid.n_cells());
  for (int i = 0; i < grid.nx * samples; ++i) {
    const double X = grid.x0 + (i + 0.5) * dx;
    column.clear();
    for (const Stencil& s : all) {
      if (s.left <= X && X <= s.right) column.cover(s, X);
    }
    column.fill(empty, X, 0);
    column.fill(solid, X, 1);
    column.add_to(fractions.data() + grid.cell(i / samples, 0), samples);
  }
  return fractions / (samples * samples);
}

Connectivity connectivity(const Grid& grid, const VectorXd& fractions) {
  assert(fractions.size() == grid.n_cells());
  Pieces pieces(grid, fractions);
  Connectivity result;
  int count = 0;
  for (int i = 0; i < grid.nx; ++i) {
    for (int j = 0; j < grid.ny; ++j) {
      if (!pieces.is_open(i, j)) continue;
      ++count;
      result.connected = pieces.take(i, j).spans || result.connected;
    }
  }
  result.islands = std::max(0, count - 1);
  return result;
}

}  // namespace flexmorph
