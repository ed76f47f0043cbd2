#include "fem/terms/factor_moments.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace flexmorph::fem {
namespace {

/// Returns the first and the last cell that an interval covers; positions behind the last line of
/// the grid belong to its last cell. Lines that coincide up to round-off are one line.
std::pair<int, int> cells_of(double start, double end, double grid_start, double cell, int n) {
  const auto index = [&](double x) {
    return std::clamp(static_cast<int>(std::floor((x - grid_start) / cell)), 0, n - 1);
  };
  const double tiny = 1e-12 * cell;
  return {index(start + tiny), index(end - tiny)};
}

/// Returns the integrals of the Lagrange polynomials over the part of cell k, one of [first, last],
/// that lies in an interval.
VectorXd integrals(int n, int k, std::pair<int, int> cells, double start, double end,
                   double grid_start, double cell) {
  const double length = end - start;
  const double lower = k == cells.first ? 0 : (grid_start + k * cell - start) / length,
               upper = k == cells.second ? 1 : (grid_start + (k + 1) * cell - start) / length;
  return lagrange_integrals(n, lower, upper);
}

}  // namespace

void ScaleFactorMoments::follow(const Element& element, const ScaleFactors& factors,
                                const VectorXd& factor, int n, bool all) {
  const bool cut =
      element.n_shapes() != 4 && !factors.uniform() && element.cells(0, factors.grid).i1 > 0;
  if (!cut) return rows_.clear();
  auto lines = element.lines();
  along_ = std::move(lines[0]);
  if (all || rows_.empty() || across_ != lines[1]) prepare(lines[1], factors.grid, factor, n);
}

bool ScaleFactorMoments::weigh(int e, MatrixXd& out) const {
  if (rows_.empty()) return false;
  const auto i = static_cast<size_t>(e) / rows_.size(), j = static_cast<size_t>(e) % rows_.size();
  weights(along_[i], along_[i + 1], static_cast<int>(j), out);
  return true;
}

void ScaleFactorMoments::prepare(const std::vector<double>& across, const Grid& grid,
                                 const VectorXd& factor, int n) {
  grid_ = grid;
  n_ = n;
  across_ = across;
  rows_.clear();
  for (size_t j = 0; j + 1 < across.size(); ++j) {
    const double low = across[j], high = across[j + 1];
    const auto cells = cells_of(low, high, grid.y0, grid.dy(), grid.ny);
    MatrixXd& row = rows_.emplace_back(MatrixXd::Zero(n, grid.nx));
    for (int r = cells.first; r <= cells.second; ++r) {
      const VectorXd part = integrals(n, r, cells, low, high, grid.y0, grid.dy());
      for (int c = 0; c < grid.nx; ++c) row.col(c) += factor[grid.cell(c, r)] * part;
    }
  }
}

void ScaleFactorMoments::weights(double start, double end, int j, MatrixXd& out) const {
  const auto row = static_cast<size_t>(j);
  const auto cells = cells_of(start, end, grid_.x0, grid_.dx(), grid_.nx);
  const double area = (end - start) * (across_[row + 1] - across_[row]);
  out.setZero(n_, n_);
  for (int c = cells.first; c <= cells.second; ++c)
    out.noalias() += area * integrals(n_, c, cells, start, end, grid_.x0, grid_.dx()) *
                     rows_[row].col(c).transpose();
}

}  // namespace flexmorph::fem
