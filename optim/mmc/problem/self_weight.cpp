#include "optim/mmc/problem/self_weight.h"

#include "fem/solve/q4_cell.h"

namespace flexmorph::mmc {
namespace {

/// Calls use(cell, node) for the four nodes of every cell of the domain.
template <class Use>
void for_corners(const Grid& grid, std::span<const signed char> outside, Use use) {
  for (int i = 0; i < grid.nx; ++i)
    for (int j = 0; j < grid.ny; ++j) {
      const int cell = grid.cell(i, j);
      if (!outside.empty() && outside[static_cast<std::size_t>(cell)]) continue;
      for (std::size_t c = 0; c < 4; ++c)
        use(cell, grid.node(i + fem::kCornerI[c], j + fem::kCornerJ[c]));
    }
}

}  // namespace

SelfWeight::SelfWeight(const fem::StaticSolver& solver, const Vec2& gravity,
                       std::span<const signed char> outside)
    : grid_(solver.grid()),
      force_(0.25 * solver.section().density * solver.section().thickness * grid_.dx() *
             grid_.dy() * gravity),
      rows_(solver.rows().begin(), solver.rows().end()),
      outside_(outside.begin(), outside.end()) {}

void SelfWeight::add(const VectorXd& mass, MatrixXd& F) const {
  for_corners(grid_, outside_, [&](int cell, int node) {
    for (int c = 0; c < 2; ++c)
      if (const int row = rows_[2 * static_cast<std::size_t>(node) + static_cast<std::size_t>(c)];
          row >= 0)
        F.col(row).array() += mass[cell] * force_[c];
  });
}

MatrixXd SelfWeight::work(const MatrixXd& u) const {
  MatrixXd out = MatrixXd::Zero(u.rows(), grid_.n_cells());
  for_corners(grid_, outside_, [&](int cell, int node) {
    for (int c = 0; c < 2; ++c)
      if (const int row = rows_[2 * static_cast<std::size_t>(node) + static_cast<std::size_t>(c)];
          row >= 0)
        out.col(cell) += force_[c] * u.col(row);
  });
  return out;
}

}  // namespace flexmorph::mmc
