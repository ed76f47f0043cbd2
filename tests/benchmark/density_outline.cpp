#include "tests/benchmark/density_outline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "fem/solve/q4_cell.h"

namespace flexmorph::benchmark {
namespace {

/// Fraction of a side by which a contour stays away from its ends, so that no two points coincide.
constexpr double kAway = 1e-6;

/// Contours by marching over quarters of cells: triangles made of a side of a cell and its centre.
/// The corners of triangles are numbered, nodes first, then centres; then follow the points where a
/// contour crosses sides, in the order in which they are found.
class Marching {
 public:
  Marching(const mmc::Plate& plate, const VectorXd& cells, double level)
      : plate_(plate),
        grid_(plate.grid),
        level_(level),
        values_(grid_.n_nodes() + grid_.n_cells()) {
    values_ << nodal_means(plate, cells), cells;
    for (int i = 0; i < grid_.nx; ++i)
      for (int j = 0; j < grid_.ny; ++j)
        if (plate_.has(grid_.cell(i, j))) add_cell(i, j);
  }

  std::vector<std::vector<Vec2>> rings() {
    std::vector<std::vector<Vec2>> out;
    while (!sides_.empty()) {
      const int first = sides_.begin()->first;
      std::vector<Vec2> ring;
      int at = first;
      do {
        const auto next = sides_.lower_bound({at, -1});
        ring.push_back(position(at));
        at = next->second;
        sides_.erase(next);
      } while (at != first);
      ring = without_straight_corners(ring);
      if (ring.size() >= 3) out.push_back(std::move(ring));
    }
    return out;
  }

 private:
  bool above(int corner) const { return values_[corner] > level_; }

  Vec2 corner_at(int corner) const {
    const int cell = corner - grid_.n_nodes();
    return cell < 0 ? grid_.node_position(corner / (grid_.ny + 1), corner % (grid_.ny + 1))
                    : grid_.cell_center(cell / grid_.ny, cell % grid_.ny);
  }

  /// Returns the number of the crossing point on the side between two corners.
  int crossing(int a, int b) {
    const auto [low, high] = std::minmax(a, b);
    const auto [at, fresh] = crossings_.try_emplace(
        {low, high}, static_cast<int>(values_.size() + static_cast<Eigen::Index>(points_.size())));
    if (fresh) {
      const double t = (level_ - values_[low]) / (values_[high] - values_[low]);
      const double s = std::clamp(t, kAway, 1 - kAway);
      points_.push_back((1 - s) * corner_at(low) + s * corner_at(high));
    }
    return at->second;
  }

  Vec2 position(int point) const {
    const auto n = static_cast<int>(values_.size());
    return point < n ? corner_at(point) : points_[static_cast<std::size_t>(point - n)];
  }

  void add_cell(int i, int j) {
    const int centre = grid_.n_nodes() + grid_.cell(i, j);
    std::array<int, 4> corners{};
    for (std::size_t c = 0; c < 4; ++c)
      corners[c] = grid_.node(i + fem::kCornerI[c], j + fem::kCornerJ[c]);
    for (std::size_t c = 0; c < 4; ++c) add_triangle({corners[c], corners[(c + 1) % 4], centre});
  }

  void add_triangle(const std::array<int, 3>& corners) {
    std::vector<int> polygon;
    for (std::size_t c = 0; c < 3; ++c) {
      const int at = corners[c], next = corners[(c + 1) % 3];
      if (above(at)) polygon.push_back(at);
      if (above(at) != above(next)) polygon.push_back(crossing(at, next));
    }
    add_polygon(polygon);
  }

  /// A side that two triangles share in opposite directions does not belong to the outline.
  void add_polygon(const std::vector<int>& polygon) {
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const int a = polygon[k], b = polygon[(k + 1) % polygon.size()];
      if (sides_.erase({b, a}) == 0) sides_.insert({a, b});
    }
  }

  std::vector<Vec2> without_straight_corners(const std::vector<Vec2>& ring) const {
    std::vector<Vec2> out;
    const std::size_t n = ring.size();
    const double flat = 1e-9 * grid_.dx() * grid_.dy();
    for (std::size_t k = 0; k < n; ++k) {
      const Vec2 before = ring[k] - ring[(k + n - 1) % n], after = ring[(k + 1) % n] - ring[k];
      const bool straight =
          std::abs(before.x() * after.y() - before.y() * after.x()) < flat && before.dot(after) > 0;
      if (!straight) out.push_back(ring[k]);
    }
    return out;
  }

  const mmc::Plate& plate_;
  const Grid& grid_;
  double level_;
  VectorXd values_;  // at corners
  std::map<std::pair<int, int>, int> crossings_;
  std::vector<Vec2> points_;             // crossing points
  std::set<std::pair<int, int>> sides_;  // from a point to the next
};

double signed_area(const std::vector<Vec2>& ring) {
  double out = 0;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
    out += 0.5 * (a.x() * b.y() - a.y() * b.x());
  }
  return out;
}

}  // namespace

VectorXd nodal_means(const mmc::Plate& plate, const VectorXd& cells) {
  const Grid& g = plate.grid;
  VectorXd sum = VectorXd::Zero(g.n_nodes()), count = sum;
  for (int i = 0; i < g.nx; ++i)
    for (int j = 0; j < g.ny; ++j) {
      if (!plate.has(g.cell(i, j))) continue;
      for (std::size_t c = 0; c < 4; ++c) {
        const int node = g.node(i + fem::kCornerI[c], j + fem::kCornerJ[c]);
        sum[node] += cells[g.cell(i, j)];
        ++count[node];
      }
    }
  return sum.cwiseQuotient(count.cwiseMax(1));
}

std::vector<std::vector<Vec2>> contour(const mmc::Plate& plate, const VectorXd& cells,
                                       double level) {
  return Marching(plate, cells, level).rings();
}

std::vector<Region> regions_above(const mmc::BodyProblem& problem, const VectorXd& cells,
                                  double level) {
  const Region domain = mmc::domain_of(problem);
  std::vector<std::vector<Vec2>> outer = problem.solid, voids = problem.empty;
  for (std::vector<Vec2>& ring : contour(mmc::plate_of(problem), cells, level)) {
    if (signed_area(ring) > 0) {
      outer.push_back(std::move(ring));
      continue;
    }
    // Holes end where given material begins. (Material within a hole would not be connected.)
    const std::vector<std::vector<Vec2>> hole = {std::move(ring)};
    for (Region& part : unite(hole, domain, problem.solid)) voids.push_back(std::move(part.outer));
  }
  return outer.empty() ? std::vector<Region>{} : unite(outer, domain, voids);
}

DensityOutline outline_of(const mmc::BodyProblem& problem, const VectorXd& cells, double allowed) {
  constexpr int kMaximum = 60;
  DensityOutline out;
  double low = 0, high = 1;
  for (int k = 0; k < kMaximum; ++k) {
    out.level = 0.5 * (low + high);
    out.regions = regions_above(problem, cells, out.level);
    const double excess = area(out.regions) / allowed - 1;
    if (std::abs(excess) < 1e-6) return out;
    (excess > 0 ? low : high) = out.level;
  }
  throw Error::numerical("no contour of the densities encloses the allowed area");
}

}  // namespace flexmorph::benchmark
