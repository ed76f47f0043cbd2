// Shows that weights from moments of the scale factors, computed column by column of cells,
// integrate polynomials like sums over all cells, including cut cells.
#include "fem/terms/factor_moments.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace flexmorph::fem {
namespace {

constexpr int kPoints = 13;

/// Returns ∫ s^p ds over [lower, upper] in [0, 1].
double power(int p, double lower, double upper) {
  return (std::pow(upper, p + 1) - std::pow(lower, p + 1)) / (p + 1);
}

struct Interval {
  double start, end;
  double part(double at) const { return std::clamp((at - start) / (end - start), 0.0, 1.0); }
  double length() const { return end - start; }
};

/// Returns Σ κ ∫ s^p u^q dA over the cells of a grid, with s and u in [0, 1] along and across an
/// element.
double over_cells(const Grid& grid, const VectorXd& factor, const Interval& m, const Interval& n,
                  int p, int q) {
  double out = 0;
  for (int c = 0; c < grid.nx; ++c)
    for (int r = 0; r < grid.ny; ++r)
      out += factor[grid.cell(c, r)] *
             power(p, m.part(grid.x0 + c * grid.dx()), m.part(grid.x0 + (c + 1) * grid.dx())) *
             power(q, n.part(grid.y0 + r * grid.dy()), n.part(grid.y0 + (r + 1) * grid.dy()));
  return m.length() * n.length() * out;
}

TEST(ScaleFactorMoments, IntegratePolynomialsAsTheCellsDo) {
  const Grid grid{0.2, -0.05, 0.6, 0.1, 60, 10};
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(0, 1);
  const VectorXd factor = VectorXd::NullaryExpr(grid.n_cells(), [&] { return any(random); });
  // on lines of cells and inside cells
  const std::vector<double> across = {-0.05, -0.013, 0.02, 0.05};
  ScaleFactorMoments moments;
  moments.prepare(across, grid, factor, kPoints);
  const GaussRule& rule = gauss(kPoints);
  MatrixXd w;
  // Intervals over many cells, over parts of two cells, within one cell, and between lines of
  // cells.
  for (const Interval m :
       {Interval{0.2, 0.8}, {0.2034, 0.4127}, {0.399, 0.405}, {0.4001, 0.4009}, {0.31, 0.39}})
    for (int j = 0; j < 3; ++j) {
      const Interval n{across[static_cast<size_t>(j)], across[static_cast<size_t>(j) + 1]};
      moments.weights(m.start, m.end, j, w);
      for (int p = 0; p < kPoints; p += 3)
        for (int q = 0; q < kPoints; q += 4) {
          double sum = 0;
          for (int g = 0; g < kPoints; ++g)
            for (int h = 0; h < kPoints; ++h)
              sum += w(g, h) * std::pow(rule.points[static_cast<size_t>(g)], p) *
                     std::pow(rule.points[static_cast<size_t>(h)], q);
          EXPECT_NEAR(sum, over_cells(grid, factor, m, n, p, q), 1e-12 * m.length() * n.length())
              << m.start << " " << j << " " << p << " " << q;
        }
    }
}

}  // namespace
}  // namespace flexmorph::fem
