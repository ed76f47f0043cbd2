#include "optim/mmc/loads/load_solver.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>

#include "geometry/archive.h"
#include "optim/mmc/loads/restrained_expansion.h"

namespace flexmorph::mmc {

namespace {

/// Returns the column of F of every displacement (2 n_nodes): for a link its own index, otherwise
/// the unknown of the solver or -1.
std::vector<int> columns_of(const fem::StaticSolver& solver, bool is_link) {
  std::vector<int> out(solver.rows().begin(), solver.rows().end());
  if (is_link) std::iota(out.begin(), out.end(), 0);
  return out;
}

/// Returns the checksum of a vector, which is not zero.
std::uint64_t checksum_of(const VectorXd& v) {
  const auto* bytes = reinterpret_cast<const char*>(v.data());
  return std::max<std::uint64_t>(
      1, checksum({bytes, sizeof(double) * static_cast<std::size_t>(v.size())}));
}

}  // namespace

std::vector<int> root_columns_of(const fem::EslSets& loads) {
  std::vector<int> columns(loads.sets.size());
  std::transform(loads.sets.begin(), loads.sets.end(), columns.begin(),
                 [](const fem::EslSet& s) { return s.root_column; });
  return columns;
}

LoadSolver::LoadSolver(fem::StaticSolver of, bool is_link)
    : solver(std::move(of)),
      inertia(solver.grid(), solver.section(), columns_of(solver, is_link)) {}

std::uint64_t LoadSolver::factored_checksum() const {
  return factored.size() > 0 ? checksum_of(factored) : counted;
}

void LoadSolver::factorize(const VectorXd& stiffness) {
  if (factored.size() == stiffness.size() && factored == stiffness) return;
  factored.resize(0);
  if (counted == 0 || counted != checksum_of(stiffness)) ++factorizations;
  counted = 0;
  solver.factorize(stiffness);
  factored = stiffness;
}

const MatrixXd& LoadSolver::forces(const StaticLoads& of, const VectorXd& mass) {
  if (!of.follows_design()) {
    if (!weight) return of.fixed;
    F = of.fixed;
    weight->add(mass, F);
    return F;
  }
  if (balance)
    balance->forces(of, mass, F, a_link);
  else
    inertia.forces(of, mass, F);
  return F;
}

void LoadSolver::to_unknowns(const MatrixXd& at_nodes, MatrixXd& x) const {
  x.resize(at_nodes.rows(), solver.n_unknowns());
  for (int k = 0; k < at_nodes.cols(); ++k)
    if (const int row = solver.row(k / 2, k % 2); row >= 0) x.col(row) = at_nodes.col(k);
}

void LoadSolver::to_nodes(const MatrixXd& x, MatrixXd& at_nodes) const {
  at_nodes.setZero(x.rows(), 2 * solver.grid().n_nodes());
  for (int k = 0; k < at_nodes.cols(); ++k)
    if (const int row = solver.row(k / 2, k % 2); row >= 0) at_nodes.col(k) = x.col(row);
}

const MatrixXd& LoadSolver::solve(const MatrixXd& of, std::span<const int> root_columns) {
  if (balance)
    to_unknowns(of, U);
  else
    U = of;
  solver.solve(U, root_columns);
  if (!balance) return U;
  to_nodes(U, u_element);
  balance->choose(u_element);
  return u_element;
}

double LoadSolver::solve_sum(const MatrixXd& of) {
  if (roots.empty()) return (solved_weights.asDiagonal() * of).cwiseProduct(solve(of, {})).sum();
  if (mix.size() > 0) {
    work = of;
    solver.solve_mixed(mix, work, solved_roots, U);
    Z.noalias() = weighted_mix * U;
  } else {
    solve(of, solved_roots);
    Z.noalias() = solved_weights.asDiagonal() * U;
  }
  return of.cwiseProduct(Z).sum();
}

/// Sets entries inside the hub of each load to zero, and those on the root line unless they are
/// kept.
void LoadSolver::keep_outside(MatrixXd& field, std::span<const int> columns,
                              bool keep_root_line) const {
  const Grid& g = solver.grid();
  for (Eigen::Index l = 0; l < field.rows(); ++l) {
    const int last = columns[static_cast<std::size_t>(l)] - (keep_root_line ? 1 : 0);
    for (int i = last; i >= 0 && row_of_column(i) >= 0; --i) {
      field.block(l, row_of_column(i), 1, 2 * (g.ny + 1)).setZero();
    }
  }
}

void LoadSolver::fix_loads(const fem::EslSets& sets, const ComplianceSettings& settings,
                           const VectorXd& stiffness0, const VectorXd& mass0) {
  const std::vector<int> columns = root_columns_of(sets);
  const bool far_end = settings.support == Support::far_end;
  MatrixXd u;
  if (settings.loads == LoadDefinition::frozen) {
    u = forces(inertia_loads(sets, inertia.rows()), mass0);
    // Forces inside the hub are kept: the solver ignores them, and they keep the rank of all loads
    // low.
    if (!far_end) {
      loads.fixed = std::move(u);
      return;
    }
    factorize(stiffness0);
    solver.solve(u, columns);
  } else {
    MatrixXd deformation(static_cast<Eigen::Index>(sets.sets.size()), 2 * sets.grid.n_nodes());
    for (Eigen::Index l = 0; l < deformation.rows(); ++l)
      deformation.row(l) = sets.sets[static_cast<std::size_t>(l)].deformation.transpose();
    to_unknowns(deformation, u);
    // The displacements caused by loads alone, at the design of the motion: μ = w - g τ.
    factorize(stiffness0);
    if (auto edges = restrained_edges(sets, solver, columns, weights)) {
      edges->update(stiffness0);
      edges->take_from(u);
    }
    keep_outside(u, columns, false);
  }
  solver.apply(stiffness0, u, loads.fixed);
  keep_outside(loads.fixed, columns, far_end);
}

void LoadSolver::compress(double tolerance) {
  const bool one_support =
      std::all_of(roots.begin(), roots.end(), [this](int c) { return c == roots.front(); });
  const auto n = loads.size();
  if (n == 1) return;
  const VectorXd full = VectorXd::Ones(solver.grid().n_cells());
  const VectorXd root_weights = weights.cwiseSqrt();
  factorize(full);
  if (balance)
    to_unknowns(forces(loads, full), work);
  else
    work = forces(loads, full);
  work = root_weights.asDiagonal() * work;
  solver.forward(work);
  const MatrixXd U_r = leading_combinations(work, one_support ? tolerance : tolerance * tolerance);
  const Eigen::Index r = U_r.cols();
  // The product with `mix` costs n r operations per unknown (and n r more for the derivative), a
  // substitution costs n or r times the bandwidth.
  const Eigen::Index bandwidth = 2 * (solver.grid().ny + 2);
  const bool pays = one_support ? r < n : r * bandwidth + 2 * r * n < n * bandwidth;
  if (!pays) return;
  basis = combine(U_r.transpose() * root_weights.asDiagonal(), loads);
  if (one_support) {
    solved_weights = VectorXd::Ones(r);
    if (!roots.empty()) solved_roots.resize(static_cast<std::size_t>(r));
    return;
  }
  mix = U_r;
  for (Eigen::Index l = 0; l < n; ++l) {
    mix.row(l) *= weights(l) > 0 ? 1 / root_weights(l) : 0.0;
  }
  weighted_mix = mix.transpose() * weights.asDiagonal();
}

/// Returns the number of unknowns of the plate when it is clamped at a column of nodes.
Eigen::Index LoadSolver::rows_before(int column) const {
  const Grid& g = solver.grid();
  return Eigen::Index{2} * (g.ny + 1) * (g.nx - column);
}

/// Returns Σ w_i |y_i|² over the unknowns in front of each clamp. The member F contains y = L⁻¹ F.
double LoadSolver::plain_sum() const {
  const Eigen::Index rows = rows_before(solver.grid().nx - 1);  // unknowns of one column of nodes
  VectorXd each = VectorXd::Zero(F.rows());
  for (int i = solver.grid().nx; i > 0 && row_of_column(i) >= 0; --i) {
    const VectorXd here = F.middleCols(row_of_column(i), rows).rowwise().squaredNorm();
    for (Eigen::Index l = 0; l < each.size(); ++l)
      if (i > solved_roots[static_cast<std::size_t>(l)]) each(l) += here(l);
  }
  return solved_weights.dot(each);
}

/// Returns Σ_i w_i |y_i|² for y_i = Σ_k mix_ik y_k, as Σ_i w_i mix_iᵀ (Y Yᵀ) mix_i with the
/// unknowns in front of clamp i.
double LoadSolver::mixed_sum() const {
  std::vector<Eigen::Index> order(solved_roots.size());
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  const auto column = [&](Eigen::Index l) { return solved_roots[static_cast<std::size_t>(l)]; };
  std::stable_sort(order.begin(), order.end(),
                   [&](auto a, auto b) { return column(a) > column(b); });
  MatrixXd gram = MatrixXd::Zero(F.rows(), F.rows());
  Eigen::Index done = 0;
  double out = 0;
  for (const Eigen::Index l : order) {
    const Eigen::Index rows = rows_before(column(l));
    const auto more = F.middleCols(done, rows - done);
    if (rows > done) gram.noalias() += more * more.transpose();
    done = rows;
    out += weights(l) * mix.row(l).dot(mix.row(l) * gram);
  }
  return out;
}

double LoadSolver::forward_sum(const VectorXd& mass) {
  if (const MatrixXd& of = forces(solved(), mass); &of != &F) F = of;
  const bool mixed = mix.size() > 0;
  solver.forward(F, mixed ? std::span<const int>() : solved_roots);
  return mixed ? mixed_sum() : plain_sum();
}

}  // namespace flexmorph::mmc
