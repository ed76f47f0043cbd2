#include "geometry/parts/picture.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <string>

#include "geometry/components/component_frame.h"

namespace flexmorph {

namespace {

/// The data of one component for sampling.
struct Stencil {
  ComponentFrame frame;
  Box local;           ///< Rectangle of the component's frame that contains the outline.
  double left, right;  ///< Range of the outline along X.
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

/// The samples of one column from bottom to top: 1 where there is material.
class SampleColumn {
 public:
  SampleColumn(double y0, double step, int count)
      : y0_(y0), step_(step), count_(count), covered_(static_cast<std::size_t>(count)) {}

  void clear() { std::fill(covered_.begin(), covered_.end(), std::uint8_t{0}); }

  void cover(const Stencil& stencil, double X) {
    const IndexRange rows = indices_in(stencil.frame.column(X, stencil.local), y0_, step_, count_);
    // a copy, because writing bytes may alias any other data
    const ComponentFrame frame = stencil.frame;
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

  void fill(std::span<const std::vector<Vec2>> polygons, double X, std::uint8_t value) {
    for (const std::vector<Vec2>& polygon : polygons) {
      crossings_.clear();
      for (std::size_t k = 0; k < polygon.size(); ++k) {
        const Vec2 &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
        if ((a.x() <= X) == (b.x() <= X)) continue;
        crossings_.push_back(a.y() + (X - a.x()) * (b.y() - a.y()) / (b.x() - a.x()));
      }
      std::sort(crossings_.begin(), crossings_.end());
      for (std::size_t k = 0; k + 1 < crossings_.size(); k += 2) {
        const IndexRange rows = indices_in({crossings_[k], crossings_[k + 1]}, y0_, step_, count_);
        std::fill(covered_.begin() + rows.first, covered_.begin() + rows.end, value);
      }
    }
  }

  /// Adds the number of covered samples of every cell to `counts`; a cell has `samples` of them.
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
  std::vector<double> crossings_;
};

/// Connected regions of material (cells that share edges), found one by one.
class Pieces {
 public:
  Pieces(const Grid& grid, const VectorXd& fractions, std::span<const HeldOrLoaded> locations)
      : grid_(grid),
        open_(static_cast<std::size_t>(grid.n_cells())),
        indices_of_cell_(static_cast<std::size_t>(grid.n_cells())),
        touched_(locations.size()) {
    for (int c = 0; c < grid.n_cells(); ++c) open_[c] = fractions[c] >= 0.5;
    for (std::size_t p = 0; p < locations.size(); ++p) {
      for (const int cell : locations[p].cells)
        indices_of_cell_[cell].push_back(static_cast<int>(p));
    }
  }

  bool is_open(int i, int j) const { return open_[grid_.cell(i, j)]; }

  /// Removes the connected region that contains a cell.
  /// @returns true for the supports and loads that the region touches
  const std::vector<bool>& take(int i, int j) {
    std::fill(touched_.begin(), touched_.end(), false);
    enter(i, j);
    while (!front_.empty()) {
      const int cell = front_.back();
      front_.pop_back();
      const int column = cell / grid_.ny, row = cell % grid_.ny;
      for (const int p : indices_of_cell_[cell]) touched_[p] = true;
      if (column > 0) enter(column - 1, row);
      if (column < grid_.nx - 1) enter(column + 1, row);
      if (row > 0) enter(column, row - 1);
      if (row < grid_.ny - 1) enter(column, row + 1);
    }
    return touched_;
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
  std::vector<std::vector<int>> indices_of_cell_;
  std::vector<bool> touched_;
  std::vector<int> front_;
};

}  // namespace

std::vector<HeldOrLoaded> ends_of(const Grid& grid) {
  std::vector<HeldOrLoaded> both = {{"first edge", true, {}}, {"last edge", false, {}}};
  for (int j = 0; j < grid.ny; ++j) {
    both[0].cells.push_back(grid.cell(0, j));
    both[1].cells.push_back(grid.cell(grid.nx - 1, j));
  }
  return both;
}

std::vector<int> cells_within(const Grid& grid, const Region& region) {
  std::vector<int> cells;
  if (region.outer.empty()) return cells;
  const Box box = bounds_of(region.outer);
  for (int i = 0; i < grid.nx; ++i) {
    for (int j = 0; j < grid.ny; ++j) {
      const Vec2 center = grid.cell_center(i, j);
      const bool near =
          (center - box.lower).minCoeff() >= 0 && (box.upper - center).minCoeff() >= 0;
      if (near && contains(region, center)) cells.push_back(grid.cell(i, j));
    }
  }
  return cells;
}

std::vector<signed char> cells_outside(const Grid& grid, const Region& domain) {
  std::vector<signed char> outside(static_cast<std::size_t>(grid.n_cells()), 1);
  for (const int cell : cells_within(grid, domain)) outside[cell] = 0;
  return outside;
}

VectorXd area_fractions(const Grid& grid, std::span<const Component> components,
                        double min_half_thickness, std::span<const std::vector<Vec2>> solid,
                        std::span<const std::vector<Vec2>> empty, int samples) {
  VectorXd fractions(grid.n_cells());
  update_area_fractions(grid, components, min_half_thickness, solid, empty, grid.x0,
                        grid.x0 + grid.width, fractions, samples);
  return fractions;
}

void update_area_fractions(const Grid& grid, std::span<const Component> components,
                           double min_half_thickness, std::span<const std::vector<Vec2>> solid,
                           std::span<const std::vector<Vec2>> empty, double left, double right,
                           VectorXd& fractions, int samples) {
  if (samples < 1) {
    throw Error::input("area_fractions: samples = " + std::to_string(samples) +
                       ": at least one sample per cell is needed");
  }
  const std::vector<Stencil> all = stencils(components, min_half_thickness);
  const double dx = grid.dx() / samples, dy = grid.dy() / samples;
  const auto column_at = [&](double X) {
    return std::clamp(static_cast<int>(std::floor((X - grid.x0) / grid.dx())), 0, grid.nx - 1);
  };
  const int first = column_at(left), last = column_at(right);
  fractions.segment(grid.cell(first, 0), (last - first + 1) * grid.ny).setZero();
  SampleColumn column(grid.y0 + 0.5 * dy, dy, grid.ny * samples);
  for (int i = first * samples; i < (last + 1) * samples; ++i) {
    const double X = grid.x0 + (i + 0.5) * dx;
    column.clear();
    for (const Stencil& s : all) {
      if (s.left <= X && X <= s.right) column.cover(s, X);
    }
    column.fill(empty, X, 0);
    column.fill(solid, X, 1);
    column.add_to(fractions.data() + grid.cell(i / samples, 0), samples);
  }
  fractions.segment(grid.cell(first, 0), (last - first + 1) * grid.ny) /= samples * samples;
}

Connectivity connectivity_of(const std::vector<std::vector<bool>>& touched,
                             std::span<const HeldOrLoaded> locations) {
  Connectivity out;
  out.islands = std::max(0, static_cast<int>(touched.size()) - 1);
  for (std::size_t p = 0; p < locations.size(); ++p) {
    const bool joined = std::any_of(touched.begin(), touched.end(), [&](const auto& piece) {
      if (!piece[p]) return false;
      for (std::size_t other = 0; other < locations.size(); ++other)
        if (piece[other] && locations[other].is_support != locations[p].is_support) return true;
      return false;
    });
    if (!joined)
      (locations[p].is_support ? out.unused_supports : out.loose_loads)
          .push_back(locations[p].name);
  }
  out.connected = out.loose_loads.empty();
  // Loads on all material, such as weight, act on no cells: every support that material touches
  // carries them.
  if (std::all_of(locations.begin(), locations.end(), [](const auto& p) { return p.is_support; })) {
    out.unused_supports.clear();
    out.connected = std::any_of(touched.begin(), touched.end(), [](const auto& piece) {
      return std::find(piece.begin(), piece.end(), true) != piece.end();
    });
  }
  return out;
}

Connectivity connectivity(const Grid& grid, const VectorXd& fractions,
                          std::span<const HeldOrLoaded> locations) {
  assert(fractions.size() == grid.n_cells());
  const std::vector<HeldOrLoaded> ends =
      locations.empty() ? ends_of(grid) : std::vector<HeldOrLoaded>();
  if (locations.empty()) locations = ends;
  Pieces pieces(grid, fractions, locations);
  std::vector<std::vector<bool>> touched;
  for (int i = 0; i < grid.nx; ++i)
    for (int j = 0; j < grid.ny; ++j)
      if (pieces.is_open(i, j)) touched.push_back(pieces.take(i, j));
  return connectivity_of(touched, locations);
}

}  // namespace flexmorph
