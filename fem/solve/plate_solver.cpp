#include "fem/solve/plate_solver.h"

#include <omp.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include "fem/solve/grid_order.h"
#include "fem/solve/q4_cell.h"
#include "fem/solve/q4_matrix.h"

namespace flexmorph::fem {

namespace {

std::array<int, 4> corners_of(const Grid& g, int i, int j) {
  std::array<int, 4> nodes{};
  for (std::size_t a = 0; a < 4; ++a) nodes[a] = g.node(i + kCornerI[a], j + kCornerJ[a]);
  return nodes;
}

}  // namespace

struct PlateSolver::Impl {
  Grid grid;
  PlaneSection section;
  std::vector<char> inside;  // by cell
  std::optional<Q4Matrix> matrix;
  mutable std::vector<int> active;
  mutable VectorXd held_values;
  mutable MatrixXd energy_of_load;  // a column per thread, or the weights of all

  void number(std::span<const HeldUnknown> held);
  template <class Use>
  void each_cell(Use use) const {
    for (int i = 0; i < grid.nx; ++i)
      for (int j = 0; j < grid.ny; ++j)
        if (inside[static_cast<std::size_t>(grid.cell(i, j))]) use(i, j);
  }
  /// The same by all threads, use(i, j, thread): a cell must not need another.
  template <class Use>
  void each_cell_at_once(Use use) const {
#pragma omp parallel for schedule(static)
    for (int i = 0; i < grid.nx; ++i)
      for (int j = 0; j < grid.ny; ++j)
        if (inside[static_cast<std::size_t>(grid.cell(i, j))]) use(i, j, omp_get_thread_num());
  }
  Q4Energy::Corners corner_values(const MatrixXd& u, int i, int j) const;
};

void PlateSolver::Impl::number(std::span<const HeldUnknown> held) {
  const std::size_t n_nodes = static_cast<std::size_t>(grid.n_nodes());
  std::vector<char> exists(2 * n_nodes, 0);
  each_cell([&](int i, int j) {
    for (const int node : corners_of(grid, i, j))
      exists[2 * static_cast<std::size_t>(node)] = exists[2 * static_cast<std::size_t>(node) + 1] =
          1;
  });
  for (const HeldUnknown& h : held) {
    if (h.node < 0 || h.node >= grid.n_nodes() || h.component < 0 || h.component > 1)
      throw Error::input("plate solver: node " + std::to_string(h.node) + ", component " +
                         std::to_string(h.component) + " is not of this grid");
    exists[2 * static_cast<std::size_t>(h.node) + static_cast<std::size_t>(h.component)] = 0;
  }
  int n = 0;
  std::vector<int> rows(2 * n_nodes, -1), cells;
  for (const int node : dissection_order(grid))  // both displacements of a node stay together
    for (std::size_t c = 0; c < 2; ++c) {
      const std::size_t k = 2 * static_cast<std::size_t>(node) + c;
      if (exists[k] == 0) continue;
      rows[k] = n++;
    }
  if (n == 0) throw Error::input("plate solver: every displacement is held");
  each_cell([&](int i, int j) { cells.push_back(grid.cell(i, j)); });
  matrix.emplace(grid, section, std::move(cells), std::move(rows));
}

PlateSolver::PlateSolver(const Grid& grid, const PlaneSection& section,
                         std::span<const HeldUnknown> held, std::span<const signed char> outside)
    : impl_(std::make_unique<Impl>()) {
  Impl& m = *impl_;
  m.grid = grid;
  m.section = section;
  m.inside.assign(static_cast<std::size_t>(grid.n_cells()), 1);
  for (std::size_t c = 0; c < outside.size(); ++c) m.inside[c] = outside[c] == 0 ? 1 : 0;
  m.number(held);
}

PlateSolver::~PlateSolver() = default;
PlateSolver::PlateSolver(PlateSolver&&) noexcept = default;

const Grid& PlateSolver::grid() const { return impl_->grid; }
int PlateSolver::n_unknowns() const { return impl_->matrix->size(); }
int PlateSolver::row(int node, int component) const { return impl_->matrix->row(node, component); }

double PlateSolver::condition() const { return impl_->matrix->factor().condition(); }

void PlateSolver::factorize(const VectorXd& stiffness_factor) {
  Impl& m = *impl_;
  if (stiffness_factor.size() != m.grid.n_cells() || !stiffness_factor.allFinite())
    throw Error::numerical("plate solver: the stiffness factors of " +
                           std::to_string(m.grid.n_cells()) + " cells are not all finite numbers");
  m.matrix->assemble(stiffness_factor);
  const int column = m.matrix->factor().factorize();
  if (column < 0) return;
  const int unknown = m.matrix->displacement_of(column), node = unknown / 2;
  throw Error::numerical(
      "plate solver: the stiffness is not positive definite at the " +
      std::string(unknown % 2 == 0 ? "x" : "y") + "-displacement of node column " +
      std::to_string(node / (m.grid.ny + 1)) + ", row " + std::to_string(node % (m.grid.ny + 1)) +
      ": the supports must hold the plate against shifts and turning, and no part may float");
}

void PlateSolver::solve(MatrixXd& loads) const {
  forward(loads);
  impl_->matrix->factor().backward(loads, impl_->active);
}

void PlateSolver::forward(MatrixXd& loads) const {
  const Impl& m = *impl_;
  m.active.assign(static_cast<std::size_t>(loads.rows()), m.matrix->size());
  m.matrix->factor().forward(loads, m.active);
}

Q4Energy::Corners PlateSolver::Impl::corner_values(const MatrixXd& u, int i, int j) const {
  const auto cell = matrix->rows_of_cell(i, j);
  const auto value = [&](int row) {
    return row < 0 ? held_values.data() : u.data() + static_cast<std::ptrdiff_t>(row) * u.rows();
  };
  Q4Energy::Corners x;
  for (std::size_t a = 0; a < 4; ++a) {
    x.u[a] = value(cell[2 * a]);
    x.v[a] = value(cell[2 * a + 1]);
  }
  return x;
}

void PlateSolver::cell_energies(const MatrixXd& displacements, const VectorXd& weights,
                                VectorXd& energies) const {
  const Impl& m = *impl_;
  const Q4Energy energy(m.section, m.grid.dx(), m.grid.dy());
  const Eigen::Index n_loads = displacements.rows();
  energies.setZero(m.grid.n_cells());
  m.held_values.setZero(n_loads);
  m.energy_of_load.resize((n_loads + 7) / 8 * 8, omp_get_max_threads());  // columns begin alike
  m.each_cell_at_once([&](int i, int j, int thread) {
    auto each = m.energy_of_load.col(thread);
    energy.weighted(m.corner_values(displacements, i, j), weights.data(), n_loads, each.data());
    energies(m.grid.cell(i, j)) = each.head(n_loads).sum();
  });
}

void PlateSolver::cell_forces(const VectorXd& displacements,
                              const Eigen::SparseMatrix<double>& directions,
                              MatrixXd& forces) const {
  const Impl& m = *impl_;
  Eigen::Matrix<double, 8, Eigen::Dynamic> each(8, m.grid.n_cells());
  m.each_cell([&](int i, int j) {
    const auto rows = m.matrix->rows_of_cell(i, j);
    Eigen::Matrix<double, 8, 1> u;
    for (int k = 0; k < 8; ++k) {
      const int row = rows[static_cast<std::size_t>(k)];
      u[k] = row < 0 ? 0.0 : displacements[row];
    }
    each.col(m.grid.cell(i, j)).noalias() = m.matrix->cell_stiffness() * u;
  });
  forces.setZero(directions.cols(), m.matrix->size());
  for (Eigen::Index d = 0; d < directions.cols(); ++d)
    for (Eigen::SparseMatrix<double>::InnerIterator at(directions, d); at; ++at) {
      const int cell = static_cast<int>(at.row());
      if (m.inside[static_cast<std::size_t>(cell)] == 0) continue;
      const auto rows = m.matrix->rows_of_cell(cell / m.grid.ny, cell % m.grid.ny);
      for (int k = 0; k < 8; ++k)
        if (const int row = rows[static_cast<std::size_t>(k)]; row >= 0)
          forces(d, row) += at.value() * each(k, cell);
    }
}

void PlateSolver::cell_energies(const MatrixXd& displacements, MatrixXd& energies) const {
  const Impl& m = *impl_;
  const Q4Energy energy(m.section, m.grid.dx(), m.grid.dy());
  const Eigen::Index n_loads = displacements.rows();
  energies.setZero(n_loads, m.grid.n_cells());
  m.held_values.setZero(n_loads);
  m.energy_of_load.setOnes(n_loads, 1);  // the weights
  m.each_cell_at_once([&](int i, int j, int) {
    energy.weighted(m.corner_values(displacements, i, j), m.energy_of_load.data(), n_loads,
                    energies.col(m.grid.cell(i, j)).data());
  });
}

}  // namespace flexmorph::fem
