#include "fem/solve/static_solver.h"

#include <cblas.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "fem/solve/q4_matrix.h"

namespace flexmorph::fem {

namespace {

/// The loads that move cells of column i: a range that holds all with root_columns[l] <= i.
std::pair<Eigen::Index, Eigen::Index> moving_loads(std::span<const int> root_columns, int i,
                                                   Eigen::Index n_loads) {
  if (root_columns.empty()) return {0, n_loads};
  const auto moves = [i](int root) { return root <= i; };
  const auto first = std::find_if(root_columns.begin(), root_columns.end(), moves);
  const auto last = std::find_if(root_columns.rbegin(), root_columns.rend(), moves).base();
  if (first >= last) return {0, 0};
  return {first - root_columns.begin(), last - first};
}

}  // namespace

struct StaticSolver::Impl {
  Grid grid;
  int first_root = 0;
  PlaneSection section;
  std::optional<Q4Matrix> matrix;
  VectorXd stiffness;  // factors of the last factorize()
  double edge_stiffness = 0;

  // Work space.
  mutable std::vector<int> active, order, all_active;
  mutable MatrixXd sorted_mix;
  mutable VectorXd moved, held;
  mutable MatrixXd energy_of_load;  // a column per thread

  int block_size() const { return 2 * (grid.ny + 1); }
  int n_unknowns() const { return block_size() * (grid.nx - first_root); }
  int row(int i, int j) const {
    return i <= first_root ? -1 : 2 * ((grid.nx - i) * (grid.ny + 1) + j);
  }

  void number();
  void add_edge(std::span<double> values) const;
  void check_roots(std::span<const int> root_columns, Eigen::Index n_loads) const;
  bool arrange(std::span<const int> root_columns) const;
  void to_order(MatrixXd& x) const;
  void from_order(MatrixXd& x) const;
};

/// Column by column from the free end to the root.
void StaticSolver::Impl::number() {
  std::vector<int> rows, cells;
  for (int i = 0; i <= grid.nx; ++i)
    for (int j = 0; j <= grid.ny; ++j) {
      rows.push_back(row(i, j));
      rows.push_back(i <= first_root ? -1 : row(i, j) + 1);
    }
  for (int cell = grid.cell(first_root, 0); cell < grid.n_cells(); ++cell) cells.push_back(cell);
  std::optional<std::pair<int, int>> ends;  // of the edge, in x
  if (edge_stiffness > 0) ends = {row(grid.nx, grid.ny), row(grid.nx, 0)};
  matrix.emplace(grid, section, std::move(cells), std::move(rows), ends);
}

/// Neighbours on the edge are corners 1 and 2 of a cell: unknowns 2 and 4 (x), 3 and 5 (y) of it.
/// Σ (δ_j - Σ δ / ny)² = Σ δ_j² - (u_ny - u_0)² / ny couples its ends.
void StaticSolver::Impl::add_edge(std::span<double> values) const {
  const auto value = [&](int j, std::size_t a, std::size_t b) -> double& {
    const int place = grid.cell(grid.nx - 1, j) - grid.cell(first_root, 0);
    return values[static_cast<std::size_t>(matrix->entry(static_cast<std::size_t>(place), a, b))];
  };
  for (int j = 0; j < grid.ny; ++j)
    for (const std::size_t c : {2u, 3u}) {
      value(j, c, c) += edge_stiffness;
      value(j, c + 2, c + 2) += edge_stiffness;
      value(j, c + 2, c) -= edge_stiffness;
    }
  const double mean = edge_stiffness / grid.ny;
  value(0, 2, 2) -= mean;
  value(grid.ny - 1, 4, 4) -= mean;
  values[static_cast<std::size_t>(matrix->further_entry())] += mean;
}

void StaticSolver::Impl::check_roots(std::span<const int> root_columns,
                                     Eigen::Index n_loads) const {
  if (static_cast<Eigen::Index>(root_columns.size()) != n_loads) {
    throw Error::input("static solver: " + std::to_string(n_loads) + " loads, but " +
                       std::to_string(root_columns.size()) + " root columns");
  }
  for (int c : root_columns) {
    if (c < first_root || c > grid.nx) {
      throw Error::input("static solver: root column " + std::to_string(c) + " is not between " +
                         std::to_string(first_root) + " and " + std::to_string(grid.nx));
    }
  }
}

/// Sets `active` (unknowns in front of each load's clamp), sorted when the loads are not.
/// @returns whether `order` (sorted load -> load) must be applied.
bool StaticSolver::Impl::arrange(std::span<const int> root_columns) const {
  order.resize(root_columns.size());
  std::iota(order.begin(), order.end(), 0);
  const bool sorted = std::is_sorted(root_columns.begin(), root_columns.end()) ||
                      std::is_sorted(root_columns.rbegin(), root_columns.rend());
  if (!sorted) {
    std::sort(order.begin(), order.end(), [&](int a, int b) {
      const int ca = root_columns[static_cast<std::size_t>(a)];
      const int cb = root_columns[static_cast<std::size_t>(b)];
      return ca != cb ? ca < cb : a < b;
    });
  }
  active.resize(root_columns.size());
  std::transform(order.begin(), order.end(), active.begin(), [&](int l) {
    return block_size() * (grid.nx - root_columns[static_cast<std::size_t>(l)]);
  });
  return !sorted;
}

void StaticSolver::Impl::to_order(MatrixXd& x) const {
  const auto index = Eigen::Map<const Eigen::VectorXi>(order.data(), x.rows());
  moved.resize(x.rows());
  for (Eigen::Index k = 0; k < x.cols(); ++k) {
    moved = x.col(k);
    for (Eigen::Index l = 0; l < x.rows(); ++l) x(l, k) = moved(index(l));
  }
}

void StaticSolver::Impl::from_order(MatrixXd& x) const {
  const auto index = Eigen::Map<const Eigen::VectorXi>(order.data(), x.rows());
  moved.resize(x.rows());
  for (Eigen::Index k = 0; k < x.cols(); ++k) {
    moved = x.col(k);
    for (Eigen::Index l = 0; l < x.rows(); ++l) x(index(l), k) = moved(l);
  }
}

StaticSolver::StaticSolver(const Grid& grid, const PlaneSection& section, int first_root,
                           double edge_stiffness)
    : impl_(std::make_unique<Impl>()) {
  if (first_root < 0 || first_root >= grid.nx) {
    throw Error::input("static solver: root column " + std::to_string(first_root) +
                       " leaves nothing of " + std::to_string(grid.nx) + " columns of cells");
  }
  if (!std::isfinite(edge_stiffness) || edge_stiffness < 0)
    throw Error::input("static solver: the stiffness of an edge is at least 0, not " +
                       std::to_string(edge_stiffness));
  impl_->edge_stiffness = edge_stiffness;
  impl_->grid = grid;
  impl_->first_root = first_root;
  impl_->section = section;
  impl_->number();
}

StaticSolver::~StaticSolver() = default;
StaticSolver::StaticSolver(StaticSolver&&) noexcept = default;

const Grid& StaticSolver::grid() const { return impl_->grid; }
int StaticSolver::n_unknowns() const { return impl_->n_unknowns(); }
int StaticSolver::row(int i, int j) const { return impl_->row(i, j); }

double StaticSolver::condition() const { return impl_->matrix->factor().condition(); }

void StaticSolver::factorize(const VectorXd& stiffness_factor) {
  Impl& m = *impl_;
  if (stiffness_factor.size() != m.grid.n_cells() || !stiffness_factor.allFinite()) {
    throw Error::numerical("static solver: the stiffness factors of " +
                           std::to_string(m.grid.n_cells()) + " cells are not all finite numbers");
  }
  m.stiffness = stiffness_factor;
  const std::span<double> values = m.matrix->assemble(stiffness_factor);
  if (m.edge_stiffness > 0) m.add_edge(values);
  const int column = m.matrix->factor().factorize();
  if (column < 0) return;
  const int node = column / 2, i = m.grid.nx - node / (m.grid.ny + 1);
  throw Error::numerical("static solver: the stiffness is not positive definite at unknown " +
                         std::to_string(column) + " (" + (column % 2 == 0 ? "x" : "y") +
                         " of node column " + std::to_string(i) + ", row " +
                         std::to_string(node % (m.grid.ny + 1)) +
                         "): stiffness factors must be positive, and no part may float");
}

void StaticSolver::solve(MatrixXd& loads, std::span<const int> root_columns) const {
  const Impl& m = *impl_;
  m.check_roots(root_columns, loads.rows());
  const bool reorder = m.arrange(root_columns);
  if (reorder) m.to_order(loads);
  m.matrix->factor().forward(loads, m.active);
  m.matrix->factor().backward(loads, m.active);
  if (reorder) m.from_order(loads);
}

void StaticSolver::solve_at_clamp(MatrixXd& loads, std::span<const int> root_columns) const {
  const Impl& m = *impl_;
  m.check_roots(root_columns, loads.rows());
  const bool reorder = m.arrange(root_columns);
  if (reorder) m.to_order(loads);
  m.matrix->factor().forward(loads, m.active, m.block_size());
  m.matrix->factor().backward(loads, m.active);
  if (reorder) m.from_order(loads);
}

void StaticSolver::solve_mixed(const MatrixXd& mix, MatrixXd& basis,
                               std::span<const int> root_columns, MatrixXd& displacements) const {
  const Impl& m = *impl_;
  m.check_roots(root_columns, mix.rows());
  const bool reorder = m.arrange(root_columns);
  displacements.resize(mix.rows(), m.n_unknowns());
  if (mix.rows() == 0) return;
  const int r = static_cast<int>(mix.cols()), ld = static_cast<int>(mix.rows());
  m.all_active.assign(static_cast<std::size_t>(r),
                      *std::max_element(m.active.begin(), m.active.end()));
  m.matrix->factor().forward(basis, m.all_active);
  const MatrixXd* weights = &mix;
  if (reorder) {
    m.sorted_mix = mix;
    m.to_order(m.sorted_mix);
    weights = &m.sorted_mix;
  }
  m.matrix->factor().backward(displacements, m.active,
                              [&](int first, int last, int load, int count) {
                                cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, count,
                                            last - first, r, 1, weights->data() + load, ld,
                                            basis.data() + static_cast<std::ptrdiff_t>(first) * r,
                                            r, 0, &displacements(load, first), ld);
                              });
  if (reorder) m.from_order(displacements);
}

void StaticSolver::forward(MatrixXd& loads) const {
  const Impl& m = *impl_;
  m.all_active.assign(static_cast<std::size_t>(loads.rows()), m.n_unknowns());
  m.matrix->factor().forward(loads, m.all_active);
}

void StaticSolver::forward(MatrixXd& loads, std::span<const int> root_columns) const {
  const Impl& m = *impl_;
  m.check_roots(root_columns, loads.rows());
  const bool reorder = m.arrange(root_columns);
  if (reorder) m.to_order(loads);
  m.matrix->factor().forward(loads, m.active);
  if (reorder) m.from_order(loads);
}

void StaticSolver::cell_energies(const MatrixXd& displacements, const VectorXd& weights,
                                 VectorXd& energies, std::span<const int> root_columns) const {
  const Impl& m = *impl_;
  const Grid& g = m.grid;
  const Q4Energy energy(m.section, g.dx(), g.dy());
  const Eigen::Index ld = displacements.rows();
  energies.setZero(g.n_cells());
  m.held.setZero(ld);
  // Columns begin alike in memory: Eigen adds in an order that depends on it.
  m.energy_of_load.resize((ld + 7) / 8 * 8, omp_get_max_threads());

#pragma omp parallel for schedule(static)
  for (int i = m.first_root; i < g.nx; ++i) {
    const auto range = moving_loads(root_columns, i, ld);
    const auto begin = range.first, n = range.second;
    if (n == 0) continue;
    auto each = m.energy_of_load.col(omp_get_thread_num());
    const auto value = [&](int column, int j, int k) {
      const int row = m.row(column, j);
      return row < 0 ? m.held.data() : displacements.data() + (row + k) * ld + begin;
    };
    for (int j = 0; j < g.ny; ++j) {
      Q4Energy::Corners x;
      for (std::size_t a = 0; a < 4; ++a) {
        x.u[a] = value(i + kCornerI[a], j + kCornerJ[a], 0);
        x.v[a] = value(i + kCornerI[a], j + kCornerJ[a], 1);
      }
      energy.weighted(x, weights.data() + begin, n, each.data());
      energies(g.cell(i, j)) = each.head(n).sum();
    }
  }
}

double StaticSolver::edge_energy(const MatrixXd& displacements, const VectorXd& weights) const {
  const Impl& m = *impl_;
  if (m.edge_stiffness == 0) return 0;
  const int ny = m.grid.ny, first = m.row(m.grid.nx, 0), last = m.row(m.grid.nx, ny);
  const auto w = [&](int row) { return displacements.col(row).array(); };
  Eigen::ArrayXd sum = Eigen::ArrayXd::Zero(displacements.rows());
  const Eigen::ArrayXd mean = (w(last) - w(first)) / ny;
  for (int row = first; row < last; row += 2)
    sum += (w(row + 3) - w(row + 1)).square() + (w(row + 2) - w(row) - mean).square();
  return m.edge_stiffness * sum.matrix().dot(weights);
}

void StaticSolver::apply(const MatrixXd& displacements, MatrixXd& forces) const {
  const Impl& m = *impl_;
  if (m.stiffness.size() == 0) throw Error::numerical("static solver: factorize() comes first");
  forces.setZero(displacements.rows(), m.n_unknowns());
  for (int i = m.first_root; i < m.grid.nx; ++i) {
    for (int j = 0; j < m.grid.ny; ++j) {
      const auto rows = m.matrix->rows_of_cell(i, j);
      const double factor = m.stiffness(m.grid.cell(i, j));
      for (std::size_t a = 0; a < 8; ++a) {
        if (rows[a] < 0) continue;
        for (std::size_t b = 0; b < 8; ++b) {
          if (rows[b] < 0) continue;
          const double k =
              factor * m.matrix->cell_stiffness()(static_cast<int>(a), static_cast<int>(b));
          forces.col(rows[a]) += k * displacements.col(rows[b]);
        }
      }
    }
  }
}

}  // namespace flexmorph::fem
