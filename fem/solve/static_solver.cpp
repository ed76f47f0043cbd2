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

#include "fem/solve/factorization/grid_order.h"
#include "fem/solve/q4_matrix.h"

namespace flexmorph::fem {

namespace {

/// Returns the loads that deform cells of column i: a range that contains all with root_columns[l]
/// <= i.
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
  PlaneSection section;
  int first_root = 0;  // of a plate with a clamp
  double edge_stiffness = 0;
  std::vector<char> inside;  // by cell
  std::optional<Q4Matrix> matrix;

  // Work space.
  mutable std::vector<int> active, order, all_active;
  mutable MatrixXd sorted_mix;
  mutable VectorXd moved, held_values;
  mutable MatrixXd energy_of_load;  // a column per thread

  Impl(const Grid& g, const PlaneSection& s)
      : grid(g), section(s), inside(static_cast<std::size_t>(g.n_cells()), 1) {}
  int block_size() const { return 2 * (grid.ny + 1); }

  void number(std::span<const int> nodes, std::span<const HeldUnknown> held);
  void add_edge(std::span<double> values) const;
  bool arrange(std::span<const int> root_columns, Eigen::Index n_loads) const;
  void to_order(MatrixXd& x) const;
  void from_order(MatrixXd& x) const;
  void substitute(MatrixXd& x, std::span<const int> root_columns, int tail, bool back) const;
  Q4Energy::Corners corner_values(const MatrixXd& u, int i, int j, Eigen::Index first_load) const;
  template <class Use>
  void each_cell(Use use) const;
};

/// Numbers the unknowns of the cells' nodes, except held ones, in the given order of all nodes;
/// both unknowns of a node are consecutive.
void StaticSolver::Impl::number(std::span<const int> nodes, std::span<const HeldUnknown> held) {
  std::vector<char> exists(2 * static_cast<std::size_t>(grid.n_nodes()), 0);
  std::vector<int> rows(exists.size(), -1), cells;
  for (int cell = 0; cell < grid.n_cells(); ++cell) {
    if (!inside[static_cast<std::size_t>(cell)]) continue;
    cells.push_back(cell);
    for (std::size_t a = 0; a < 4; ++a) {
      const int node = grid.node(cell / grid.ny + kCornerI[a], cell % grid.ny + kCornerJ[a]);
      std::fill_n(exists.begin() + 2 * node, 2, 1);
    }
  }
  for (const HeldUnknown& h : held) {
    if (h.node < 0 || h.node >= grid.n_nodes() || h.component < 0 || h.component > 1)
      throw Error::input("static solver: node " + std::to_string(h.node) + ", component " +
                         std::to_string(h.component) + " does not exist on this grid");
    exists[2 * static_cast<std::size_t>(h.node) + static_cast<std::size_t>(h.component)] = 0;
  }
  int n = 0;
  for (const int node : nodes)
    for (std::size_t k = 2 * static_cast<std::size_t>(node), end = k + 2; k < end; ++k)
      if (exists[k]) rows[k] = n++;
  if (n == 0) throw Error::input("static solver: all displacements are fixed");
  std::optional<std::pair<int, int>> ends;  // unknowns in x at both ends of the edge
  const auto x_of = [&](int j) {
    return rows[2 * static_cast<std::size_t>(grid.node(grid.nx, j))];
  };
  if (edge_stiffness > 0) ends = {x_of(grid.ny), x_of(0)};
  matrix.emplace(grid, section, std::move(cells), std::move(rows), ends);
}

template <class Use>
void StaticSolver::Impl::each_cell(Use use) const {
  for (int cell = 0; cell < grid.n_cells(); ++cell)
    if (inside[static_cast<std::size_t>(cell)])
      use(cell, matrix->rows_of_cell(cell / grid.ny, cell % grid.ny));
}

/// Adds the penalty on the edge. Neighbours on the edge are corners 1 and 2 of a cell, its unknowns
/// 2 and 4 (x), 3 and 5 (y). Σ (δ_j - Σ δ / ny)² = Σ δ_j² - (u_ny - u_0)² / ny couples the ends of
/// the edge.
void StaticSolver::Impl::add_edge(std::span<double> values) const {
  const auto value = [&](int j, std::size_t a, std::size_t b) -> double& {
    const int value_index = grid.cell(grid.nx - 1, j) - grid.cell(first_root, 0);
    return values[static_cast<std::size_t>(
        matrix->entry(static_cast<std::size_t>(value_index), a, b))];
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

/// Sets `active` (the number of unknowns in front of each load's clamp), sorted when the loads are
/// not.
/// @returns true if `order` (sorted load -> load) must be applied.
bool StaticSolver::Impl::arrange(std::span<const int> root_columns, Eigen::Index n_loads) const {
  if (root_columns.empty()) {
    active.assign(static_cast<std::size_t>(n_loads), matrix->size());
    return false;
  }
  if (static_cast<Eigen::Index>(root_columns.size()) != n_loads) {
    throw Error::input("static solver: " + std::to_string(n_loads) + " loads are given, but " +
                       std::to_string(root_columns.size()) + " root columns");
  }
  for (int c : root_columns) {
    if (c < first_root || c > grid.nx) {
      throw Error::input("static solver: root column " + std::to_string(c) + " is not between " +
                         std::to_string(first_root) + " and " + std::to_string(grid.nx));
    }
  }
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

/// Makes the forward substitution of loads that are zero except for the last `tail` of their active
/// entries, and with `back` the backward substitution.
void StaticSolver::Impl::substitute(MatrixXd& x, std::span<const int> root_columns, int tail,
                                    bool back) const {
  const bool reorder = arrange(root_columns, x.rows());
  if (reorder) to_order(x);
  matrix->factor().forward(x, active, tail);
  if (back) matrix->factor().backward(x, active);
  if (reorder) from_order(x);
}

StaticSolver::StaticSolver(const Grid& grid, const PlaneSection& section, int first_root,
                           double edge_stiffness)
    : impl_(std::make_unique<Impl>(grid, section)) {
  if (first_root < 0 || first_root >= grid.nx) {
    throw Error::input("static solver: root column " + std::to_string(first_root) +
                       " is not one of the " + std::to_string(grid.nx) + " columns of cells");
  }
  if (!std::isfinite(edge_stiffness) || edge_stiffness < 0)
    throw Error::input("static solver: the stiffness of an edge must be at least 0, not " +
                       std::to_string(edge_stiffness));
  impl_->first_root = first_root;
  impl_->edge_stiffness = edge_stiffness;
  std::fill_n(impl_->inside.begin(), grid.cell(first_root, 0), 0);
  std::vector<int> nodes;
  std::vector<HeldUnknown> held;
  for (int i = grid.nx; i >= 0; --i)
    for (int j = 0; j <= grid.ny; ++j) nodes.push_back(grid.node(i, j));
  for (int j = 0; j <= grid.ny; ++j)
    for (int c = 0; c < 2; ++c) held.push_back({grid.node(first_root, j), c});
  impl_->number(nodes, held);
}

StaticSolver::StaticSolver(const Grid& grid, const PlaneSection& section,
                           std::span<const HeldUnknown> held, std::span<const signed char> outside)
    : impl_(std::make_unique<Impl>(grid, section)) {
  for (std::size_t c = 0; c < outside.size(); ++c) impl_->inside[c] = outside[c] == 0;
  impl_->number(dissection_order(grid), held);
}

StaticSolver::~StaticSolver() = default;
StaticSolver::StaticSolver(StaticSolver&&) noexcept = default;

const Grid& StaticSolver::grid() const { return impl_->grid; }
const PlaneSection& StaticSolver::section() const { return impl_->section; }
double StaticSolver::edge_stiffness() const { return impl_->edge_stiffness; }
bool StaticSolver::has_cell(int cell) const {
  return impl_->inside[static_cast<std::size_t>(cell)] != 0;
}
int StaticSolver::n_unknowns() const { return impl_->matrix->size(); }
std::span<const int> StaticSolver::rows() const { return impl_->matrix->rows(); }

double StaticSolver::condition() const { return impl_->matrix->factor().condition(); }

void StaticSolver::factorize(const VectorXd& stiffness_factor) {
  Impl& m = *impl_;
  if (stiffness_factor.size() != m.grid.n_cells() || !stiffness_factor.allFinite()) {
    throw Error::numerical("static solver: the stiffness factors of " +
                           std::to_string(m.grid.n_cells()) + " cells are not all finite numbers");
  }
  const std::span<double> values = m.matrix->assemble(stiffness_factor);
  if (m.edge_stiffness > 0) m.add_edge(values);
  const int column = m.matrix->factor().factorize();
  if (column < 0) return;
  const int unknown = m.matrix->displacement_of(column), node = unknown / 2;
  throw Error::numerical(
      "static solver: the stiffness is not positive definite at the " +
      std::string(unknown % 2 == 0 ? "x" : "y") + "-displacement of node column " +
      std::to_string(node / (m.grid.ny + 1)) + ", row " + std::to_string(node % (m.grid.ny + 1)) +
      ": stiffness factors must be positive, the supports must prevent translation and rotation of "
      "the plate, and every part must be connected to a support");
}

void StaticSolver::solve(MatrixXd& loads, std::span<const int> root_columns) const {
  impl_->substitute(loads, root_columns, n_unknowns(), true);
}

void StaticSolver::solve_at_clamp(MatrixXd& loads, std::span<const int> root_columns) const {
  impl_->substitute(loads, root_columns, impl_->block_size(), true);
}

void StaticSolver::forward(MatrixXd& loads, std::span<const int> root_columns) const {
  impl_->substitute(loads, root_columns, n_unknowns(), false);
}

void StaticSolver::solve_mixed(const MatrixXd& mix, MatrixXd& basis,
                               std::span<const int> root_columns, MatrixXd& displacements) const {
  const Impl& m = *impl_;
  const bool reorder = m.arrange(root_columns, mix.rows());
  displacements.resize(mix.rows(), n_unknowns());
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

/// Returns the displacements of the corners of a cell, beginning with one load.
Q4Energy::Corners StaticSolver::Impl::corner_values(const MatrixXd& u, int i, int j,
                                                    Eigen::Index first_load) const {
  const auto cell = matrix->rows_of_cell(i, j);
  const auto value = [&](int row) {
    return row < 0 ? held_values.data() : u.data() + row * u.rows() + first_load;
  };
  Q4Energy::Corners x;
  for (std::size_t a = 0; a < 4; ++a) {
    x.u[a] = value(cell[2 * a]);
    x.v[a] = value(cell[2 * a + 1]);
  }
  return x;
}

void StaticSolver::cell_energies(const MatrixXd& displacements, const VectorXd& weights,
                                 VectorXd& energies, std::span<const int> root_columns) const {
  const Impl& m = *impl_;
  const Grid& g = m.grid;
  const Q4Energy energy(m.section, g.dx(), g.dy());
  const Eigen::Index n_loads = displacements.rows();
  energies.setZero(g.n_cells());
  m.held_values.setZero(n_loads);
  // All columns have the same alignment in memory, because the order of Eigen's sums depends on it.
  m.energy_of_load.resize((n_loads + 7) / 8 * 8, omp_get_max_threads());

#pragma omp parallel for schedule(static)
  for (int i = m.first_root; i < g.nx; ++i) {
    const auto range = moving_loads(root_columns, i, n_loads);
    const auto begin = range.first, n = range.second;
    if (n == 0) continue;
    auto each = m.energy_of_load.col(omp_get_thread_num());
    for (int j = 0; j < g.ny; ++j) {
      if (!m.inside[static_cast<std::size_t>(g.cell(i, j))]) continue;
      energy.weighted(m.corner_values(displacements, i, j, begin), weights.data() + begin, n,
                      each.data());
      energies(g.cell(i, j)) = each.head(n).sum();
    }
  }
}

void StaticSolver::cell_energies(const MatrixXd& displacements, MatrixXd& energies) const {
  const Impl& m = *impl_;
  const Grid& g = m.grid;
  const Q4Energy energy(m.section, g.dx(), g.dy());
  const VectorXd ones = VectorXd::Ones(displacements.rows());
  energies.setZero(ones.size(), g.n_cells());
  m.held_values.setZero(ones.size());

#pragma omp parallel for schedule(static)
  for (int cell = g.cell(m.first_root, 0); cell < g.n_cells(); ++cell)
    if (m.inside[static_cast<std::size_t>(cell)])
      energy.weighted(m.corner_values(displacements, cell / g.ny, cell % g.ny, 0), ones.data(),
                      ones.size(), energies.col(cell).data());
}

double StaticSolver::edge_energy(const MatrixXd& displacements, const VectorXd& weights) const {
  const Impl& m = *impl_;
  if (m.edge_stiffness == 0) return 0;
  const int ny = m.grid.ny, first = row(m.grid.node(m.grid.nx, 0), 0), last = first + 2 * ny;
  const auto w = [&](int row) { return displacements.col(row).array(); };
  Eigen::ArrayXd sum = Eigen::ArrayXd::Zero(displacements.rows());
  const Eigen::ArrayXd mean = (w(last) - w(first)) / ny;
  for (int row = first; row < last; row += 2)
    sum += (w(row + 3) - w(row + 1)).square() + (w(row + 2) - w(row) - mean).square();
  return m.edge_stiffness * sum.matrix().dot(weights);
}

void StaticSolver::apply(const VectorXd& stiffness_factor, const MatrixXd& displacements,
                         MatrixXd& forces) const {
  const Impl& m = *impl_;
  forces.setZero(displacements.rows(), n_unknowns());
  m.each_cell([&](int cell, const std::array<int, 8>& rows) {
    for (std::size_t a = 0; a < 8; ++a) {
      if (rows[a] < 0) continue;
      for (std::size_t b = 0; b < 8; ++b) {
        if (rows[b] < 0) continue;
        const double k = stiffness_factor(cell) *
                         m.matrix->cell_stiffness()(static_cast<int>(a), static_cast<int>(b));
        forces.col(rows[a]) += k * displacements.col(rows[b]);
      }
    }
  });
}

void StaticSolver::cell_forces(const VectorXd& displacements,
                               const Eigen::SparseMatrix<double>& directions,
                               MatrixXd& forces) const {
  const Impl& m = *impl_;
  Eigen::Matrix<double, 8, Eigen::Dynamic> each(8, m.grid.n_cells());
  m.each_cell([&](int cell, const std::array<int, 8>& rows) {
    Eigen::Matrix<double, 8, 1> u;
    for (int k = 0; k < 8; ++k) {
      const int row = rows[static_cast<std::size_t>(k)];
      u[k] = row < 0 ? 0.0 : displacements[row];
    }
    each.col(cell).noalias() = m.matrix->cell_stiffness() * u;
  });
  forces.setZero(directions.cols(), n_unknowns());
  for (Eigen::Index d = 0; d < directions.cols(); ++d)
    for (Eigen::SparseMatrix<double>::InnerIterator at(directions, d); at; ++at) {
      const int cell = static_cast<int>(at.row());
      if (!has_cell(cell)) continue;
      const auto rows = m.matrix->rows_of_cell(cell / m.grid.ny, cell % m.grid.ny);
      for (int k = 0; k < 8; ++k)
        if (const int row = rows[static_cast<std::size_t>(k)]; row >= 0)
          forces(d, row) += at.value() * each(k, cell);
    }
}

}  // namespace flexmorph::fem
