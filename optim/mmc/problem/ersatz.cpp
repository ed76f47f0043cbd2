#include "optim/mmc/problem/ersatz.h"

#include <algorithm>
#include <array>

#include "geometry/parts/picture.h"

namespace flexmorph::mmc {
namespace {

std::array<int, 4> corners(const Grid& g, int i, int j) {
  return {g.node(i, j), g.node(i + 1, j), g.node(i + 1, j + 1), g.node(i, j + 1)};
}

}  // namespace

Ersatz::Ersatz(const Grid& grid, double alpha, std::span<const std::vector<Vec2>> solid,
               std::span<const std::vector<Vec2>> empty, std::span<const signed char> outside)
    : grid_(grid), alpha_(alpha), fixed_(static_cast<size_t>(grid.n_cells()), 0) {
  n_domain_ = grid.n_cells() - static_cast<int>(std::count(outside.begin(), outside.end(), 1));
  const auto fix = [&](std::span<const std::vector<Vec2>> polygons, signed char value) {
    for (const std::vector<Vec2>& polygon : polygons)
      for (const int cell : cells_within(grid, {polygon, {}}))
        fixed_[static_cast<size_t>(cell)] = value;
  };
  fix(empty, -1);
  fix(solid, 1);
  for (size_t cell = 0; cell < outside.size(); ++cell)
    if (outside[cell]) fixed_[cell] = -1;
}

void Ersatz::factors(const VectorXd& h, const VectorXd& eroded, CellScaleFactors& out) const {
  out.stiffness.resize(grid_.n_cells());
  out.mass.resize(grid_.n_cells());
  for (int i = 0; i < grid_.nx; ++i)
    for (int j = 0; j < grid_.ny; ++j) {
      const int cell = grid_.cell(i, j);
      const signed char fixed = fixed_[static_cast<size_t>(cell)];
      double sum = 0, squares = 0;
      for (const int node : corners(grid_, i, j)) {
        sum += h[node];
        squares += eroded[node] * eroded[node];
      }
      out.stiffness[cell] = fixed > 0 ? 1 : fixed < 0 ? alpha_ * alpha_ : 0.25 * squares;
      out.mass[cell] = fixed > 0 ? 1 : fixed < 0 ? 0 : (0.25 * sum - alpha_) / (1 - alpha_);
    }
}

void Ersatz::pull_back(const VectorXd& eroded, const VectorXd& d_stiffness, const VectorXd& d_mass,
                       VectorXd& d_h, VectorXd& d_eroded) const {
  d_h.setZero(grid_.n_nodes());
  d_eroded.setZero(grid_.n_nodes());
  for (int i = 0; i < grid_.nx; ++i)
    for (int j = 0; j < grid_.ny; ++j) {
      const int cell = grid_.cell(i, j);
      if (fixed_[static_cast<size_t>(cell)] != 0) continue;
      for (const int node : corners(grid_, i, j)) {
        d_h[node] += 0.25 * d_mass[cell] / (1 - alpha_);
        d_eroded[node] += 0.5 * d_stiffness[cell] * eroded[node];
      }
    }
}

void Ersatz::pull_back(const VectorXd& eroded, const MatrixXd& d_stiffness, const MatrixXd& d_mass,
                       MatrixXd& d_h, MatrixXd& d_eroded) const {
  const Eigen::Index n_functions = d_stiffness.rows();
  const bool masses = d_mass.size() > 0;
  d_h.setZero(masses ? n_functions : 0, masses ? grid_.n_nodes() : 0);
  d_eroded.setZero(n_functions, grid_.n_nodes());
  for (int i = 0; i < grid_.nx; ++i)
    for (int j = 0; j < grid_.ny; ++j) {
      const int cell = grid_.cell(i, j);
      if (fixed_[static_cast<size_t>(cell)] != 0) continue;
      for (const int node : corners(grid_, i, j)) {
        d_eroded.col(node) += (0.5 * eroded[node]) * d_stiffness.col(cell);
        if (masses) d_h.col(node) += (0.25 / (1 - alpha_)) * d_mass.col(cell);
      }
    }
}

VectorXd Ersatz::twice(const VectorXd& d_stiffness) const {
  VectorXd out = VectorXd::Zero(grid_.n_nodes());
  for (int i = 0; i < grid_.nx; ++i)
    for (int j = 0; j < grid_.ny; ++j) {
      const int cell = grid_.cell(i, j);
      if (fixed_[static_cast<size_t>(cell)] != 0) continue;
      for (const int node : corners(grid_, i, j)) out[node] += 0.5 * d_stiffness[cell];
    }
  return out;
}

Eigen::SparseMatrix<double> Ersatz::stiffness_gradient(const VectorXd& eroded) const {
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < grid_.nx; ++i)
    for (int j = 0; j < grid_.ny; ++j) {
      const int cell = grid_.cell(i, j);
      if (fixed_[static_cast<size_t>(cell)] != 0) continue;
      for (const int node : corners(grid_, i, j))
        entries.emplace_back(cell, node, 0.5 * eroded[node]);
    }
  Eigen::SparseMatrix<double> out(grid_.n_cells(), grid_.n_nodes());
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

std::vector<signed char> Ersatz::shaped_nodes() const {
  std::vector<signed char> out(static_cast<size_t>(grid_.n_nodes()), 0);
  for (int i = 0; i < grid_.nx; ++i)
    for (int j = 0; j < grid_.ny; ++j)
      if (fixed_[static_cast<size_t>(grid_.cell(i, j))] == 0)
        for (const int node : corners(grid_, i, j)) out[static_cast<size_t>(node)] = 1;
  return out;
}

CellScaleFactors Ersatz::crisp(const VectorXd& fractions) const {
  return dynamic(fractions, alpha_ * alpha_, 0);
}

CellScaleFactors Ersatz::dynamic(const VectorXd& fractions, double stiffness_void,
                                 double mass_void) {
  const auto blend = [&](double at_void) {
    return VectorXd(at_void + (1 - at_void) * fractions.array());
  };
  return {blend(stiffness_void), blend(mass_void)};
}

}  // namespace flexmorph::mmc
