#include <algorithm>
#include <cmath>

#include "geometry/parts/picture.h"

namespace flexmorph {
namespace {

constexpr double kRoundOff = 1e-12;  // of an area fraction

/// Sums the areas inside counterclockwise rings, cell by cell, as ∮ x dy. A side that goes upwards
/// adds the area on its left in its row of cells, a side that goes downwards subtracts it.
class Coverage {
 public:
  explicit Coverage(const Grid& grid)
      : grid_(grid), own_(VectorXd::Zero(grid.n_cells())), left_(VectorXd::Zero(grid.n_cells())) {}

  void add(const std::vector<Vec2>& ring) {
    for (size_t k = 0; k < ring.size(); ++k)
      add_side(scaled(ring[k]), scaled(ring[(k + 1) % ring.size()]));
  }

  VectorXd fractions() const {
    VectorXd out(grid_.n_cells());
    for (int j = 0; j < grid_.ny; ++j) {
      double whole = 0;
      for (int i = grid_.nx - 1; i >= 0; --i) {
        const int cell = grid_.cell(i, j);
        const double f = own_[cell] + whole;
        out[cell] = f < kRoundOff ? 0 : f > 1 - kRoundOff ? 1 : f;
        whole += left_[cell];
      }
    }
    return out;
  }

 private:
  /// Returns a position in units of cells.
  Vec2 scaled(const Vec2& p) const {
    return {(p.x() - grid_.x0) / grid_.dx(), (p.y() - grid_.y0) / grid_.dy()};
  }

  void add_side(const Vec2& a, const Vec2& b) {
    cuts_.assign({0.0, 1.0});
    for (int c = 0; c < 2; ++c) {
      const double low = std::min(a[c], b[c]), high = std::max(a[c], b[c]);
      for (double line = std::floor(low) + 1; line < high; ++line)
        cuts_.push_back((line - a[c]) / (b[c] - a[c]));
    }
    std::sort(cuts_.begin(), cuts_.end());
    for (size_t k = 0; k + 1 < cuts_.size(); ++k) {
      const Vec2 p = a + cuts_[k] * (b - a), q = a + cuts_[k + 1] * (b - a), middle = 0.5 * (p + q);
      const int i = std::clamp(static_cast<int>(std::floor(middle.x())), 0, grid_.nx - 1),
                j = std::clamp(static_cast<int>(std::floor(middle.y())), 0, grid_.ny - 1);
      own_[grid_.cell(i, j)] += (q.y() - p.y()) * (middle.x() - i);
      left_[grid_.cell(i, j)] += q.y() - p.y();
    }
  }

  const Grid& grid_;
  VectorXd own_, left_;
  std::vector<double> cuts_;
};

}  // namespace

VectorXd area_fractions(const Grid& grid, std::span<const Region> regions) {
  Coverage coverage(grid);
  for (const Region& r : regions) {
    coverage.add(r.outer);
    for (const std::vector<Vec2>& hole : r.holes) coverage.add(hole);
  }
  return coverage.fractions();
}

}  // namespace flexmorph
