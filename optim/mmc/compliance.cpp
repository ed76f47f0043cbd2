#include "optim/mmc/compliance.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

#include "geometry/cpu_time.h"
#include "optim/mmc/held_expansion.h"
#include "optim/mmc/load_checks.h"
#include "optim/mmc/static_loads.h"

namespace flexmorph::mmc {

namespace {

std::vector<int> root_columns_of(const fem::EslSets& loads) {
  std::vector<int> columns(loads.sets.size());
  std::transform(loads.sets.begin(), loads.sets.end(), columns.begin(),
                 [](const fem::EslSet& s) { return s.root_column; });
  return columns;
}

int first_root(const fem::EslSets& loads, Support support) {
  if (support == Support::far_end) return 0;
  const std::vector<int> columns = root_columns_of(loads);
  return *std::min_element(columns.begin(), columns.end());
}

}  // namespace

/// How the loads go through the solver.
///
///   each    every load by itself
///   shared  one support: f depends on Σ w F Fᵀ only, r singular vectors replace the loads
///   mixed   moving root: r forward substitutions, displacements of every load
enum class Path { each, shared, mixed };

struct Compliance::Impl {
  fem::StaticSolver solver;
  InertiaOperator inertia;
  Path path = Path::each;
  StaticLoads loads;        // all of them
  StaticLoads basis;        // what path shared or mixed solves instead
  MatrixXd mix;             // (n x r): loads = mix * basis (path mixed)
  MatrixXd weighted_mix;    // (r x n): mixᵀ diag(w)
  VectorXd weights;         // (n)
  VectorXd solved_weights;  // of the right-hand sides whose displacements are kept
  std::vector<int> root_columns, solved_columns;
  VectorXd factored;       // stiffness factors the solver holds
  MatrixXd F, work, U, Z;  // reused by every evaluation
  VectorXd energies, products;
  std::optional<HeldExpansion> held;  // where edges cannot grow with a hot plate
  VectorXd stretch;                   // a of each load; empty when all are cold
  Seconds seconds;
  int factorizations = 0;

  Impl(const fem::EslSets& sets, const fem::PlaneSection& section, int root)
      : solver(sets.grid, section, root, edge_stiffness(sets, section)), inertia(solver, section) {}

  const StaticLoads& solved() const { return path == Path::each ? loads : basis; }

  void factorize(const VectorXd& stiffness) {
    if (factored.size() == stiffness.size() && factored == stiffness) return;
    factored.resize(0);
    ++factorizations;
    solver.factorize(stiffness);
    factored = stiffness;
  }
  HeldExpansion& held_at(const VectorXd& stiffness) {
    held->update(stiffness, solver);
    return *held;
  }
  void warm_up(const fem::EslSets& sets, const fem::PlaneSection& section);
  void fixed_loads(const fem::EslSets& sets, const fem::PlaneSection& section,
                   const ComplianceSettings& settings, const VectorXd& stiffness0,
                   const VectorXd& mass0);
  void keep_outside(MatrixXd& field, std::span<const int> columns, bool keep_root_line) const;
  void compress(double tolerance);
  void solve_all();
  Eigen::Index rows_before(int column) const;
  double plain_sum() const;
  double mixed_sum() const;
  void solve_single(int load, const VectorXd& mass, MatrixXd& u);
};

/// Zeroes what lies inside the hub of each load, and on the root line unless it is kept.
void Compliance::Impl::keep_outside(MatrixXd& field, std::span<const int> columns,
                                    bool keep_root_line) const {
  const Grid& g = solver.grid();
  for (Eigen::Index l = 0; l < field.rows(); ++l) {
    const int last = columns[static_cast<std::size_t>(l)] - (keep_root_line ? 1 : 0);
    for (int i = last; i >= 0 && solver.row(i, 0) >= 0; --i) {
      field.block(l, solver.row(i, 0), 1, 2 * (g.ny + 1)).setZero();
    }
  }
}

/// What there is to know about heat; nothing when all loads are cold.
void Compliance::Impl::warm_up(const fem::EslSets& sets, const fem::PlaneSection& section) {
  held = held_edges(sets, section, solver, root_columns, weights);
  const auto is_hot = [](const fem::EslSet& s) { return s.thermal_stretch != 0; };
  if (!held && std::none_of(sets.sets.begin(), sets.sets.end(), is_hot)) return;
  stretch.resize(weights.size());
  for (Eigen::Index l = 0; l < stretch.size(); ++l)
    stretch(l) = sets.sets[static_cast<std::size_t>(l)].thermal_stretch;
}

/// The loads of definitions `frozen` and `stiffness`. With the far end held, the nodal forces on
/// the root line belong to them: they are what holds the plate there in the motion.
void Compliance::Impl::fixed_loads(const fem::EslSets& sets, const fem::PlaneSection& section,
                                   const ComplianceSettings& settings, const VectorXd& stiffness0,
                                   const VectorXd& mass0) {
  const Grid& g = sets.grid;
  const std::vector<int> roots = root_columns_of(sets);
  const bool far_end = settings.support == Support::far_end;
  const auto n = static_cast<Eigen::Index>(sets.sets.size());
  MatrixXd u(n, solver.n_unknowns()), forces;
  if (settings.loads == LoadDefinition::frozen) {
    inertia.forces(inertia_loads(sets, solver), mass0, u);
    if (!far_end) {  // what lies inside the hub stays: the solver ignores it, and it keeps the rank
      loads.fixed = std::move(u);
      return;
    }
    factorize(stiffness0);
    solver.solve(u, roots);
  } else {
    factorize(stiffness0);
    for (Eigen::Index l = 0; l < n; ++l) {
      for (int i = g.nx; i >= 0 && solver.row(i, 0) >= 0; --i) {
        u.block(l, solver.row(i, 0), 1, 2 * (g.ny + 1)) =
            sets.sets[static_cast<std::size_t>(l)]
                .deformation.segment(2 * g.node(i, 0), 2 * (g.ny + 1))
                .transpose();
      }
    }
    // What loads answer for: w -> μ = w - g τ at the design of the motion.
    if (auto edges = held_edges(sets, section, solver, roots, weights)) {
      edges->update(stiffness0, solver);
      edges->take_from(u);
    }
    keep_outside(u, roots, false);
  }
  solver.apply(u, forces);
  keep_outside(forces, roots, far_end);
  loads.fixed = std::move(forces);
}

/// Chooses the combinations by the energies of the uniform full plate, whatever the design: a
/// mode that costs nothing there costs nothing in a part of it.
///
/// With one support the left-out energy is the error of f and of its gradient, because the
/// combinations are orthogonal in energy. With a moving root the parts cut off destroy that
/// orthogonality and the error is of first order in the left-out state: the square root of the
/// energy must stay below the tolerance.
void Compliance::Impl::compress(double tolerance) {
  const bool one_support = std::all_of(root_columns.begin(), root_columns.end(),
                                       [this](int c) { return c == root_columns.front(); });
  const auto n = loads.size();
  const VectorXd full = VectorXd::Ones(solver.grid().n_cells());
  const VectorXd root_weights = weights.cwiseSqrt();
  factorize(full);
  inertia.forces(loads, full, work);
  work = root_weights.asDiagonal() * work;
  solver.forward(work);
  const MatrixXd U_r = leading_combinations(work, one_support ? tolerance : tolerance * tolerance);
  const Eigen::Index r = U_r.cols();
  // Mixing back costs n r per unknown (and as much for the derivative), a substitution n or r
  // times the bandwidth.
  const Eigen::Index bandwidth = 2 * (solver.grid().ny + 2);
  const bool pays = one_support ? r < n : r * bandwidth + 2 * r * n < n * bandwidth;
  if (!pays) return;
  path = one_support ? Path::shared : Path::mixed;
  basis = combine(U_r.transpose() * root_weights.asDiagonal(), loads);
  if (one_support) {
    solved_weights = VectorXd::Ones(r);
    solved_columns.assign(static_cast<std::size_t>(r), root_columns.front());
    return;
  }
  mix = U_r;
  for (Eigen::Index l = 0; l < n; ++l) {
    mix.row(l) *= weights(l) > 0 ? 1 / root_weights(l) : 0.0;
  }
  weighted_mix = mix.transpose() * weights.asDiagonal();
}

/// F of the right-hand sides -> U, and Z with Σ w F . u = Σ F . Z.
void Compliance::Impl::solve_all() {
  if (path == Path::mixed) {
    work = F;
    solver.solve_mixed(mix, work, solved_columns, U);
    Z.noalias() = weighted_mix * U;
    return;
  }
  U = F;
  solver.solve(U, solved_columns);
  if (path == Path::each) {
    Z.noalias() = solved_weights.asDiagonal() * U;
  } else {
    Z = U;
  }
}

/// Unknowns of the plate clamped at a column of nodes.
Eigen::Index Compliance::Impl::rows_before(int column) const {
  const Grid& g = solver.grid();
  return Eigen::Index{2} * (g.ny + 1) * (g.nx - column);
}

/// Σ w_i |y_i|² of the rows before each clamp; F holds y = L⁻¹ F.
double Compliance::Impl::plain_sum() const {
  const Eigen::Index rows = rows_before(solver.grid().nx - 1);  // of a column of nodes
  VectorXd each = VectorXd::Zero(F.rows());
  for (int i = solver.grid().nx; i > 0 && solver.row(i, 0) >= 0; --i) {
    const VectorXd here = F.middleCols(solver.row(i, 0), rows).rowwise().squaredNorm();
    for (Eigen::Index l = 0; l < each.size(); ++l)
      if (i > solved_columns[static_cast<std::size_t>(l)]) each(l) += here(l);
  }
  return solved_weights.dot(each);
}

/// The same of y_i = Σ_k mix_ik y_k: Σ_i w_i mix_iᵀ (Y Yᵀ) mix_i with the rows before clamp i.
double Compliance::Impl::mixed_sum() const {
  std::vector<Eigen::Index> order(solved_columns.size());
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  const auto column = [&](Eigen::Index l) { return solved_columns[static_cast<std::size_t>(l)]; };
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

Compliance::Compliance(const fem::EslSets& loads, const fem::PlaneSection& section,
                       const ComplianceSettings& settings, const VectorXd& stiffness0,
                       const VectorXd& mass0) {
  check_loads(loads, settings, stiffness0, mass0);
  if (is_of_link(settings.support))
    throw Error::input("equivalent static loads: 'pins' and 'floating' are supports of links");
  impl_ = std::make_unique<Impl>(loads, section, first_root(loads, settings.support));
  Impl& m = *impl_;
  m.root_columns = root_columns_of(loads);
  if (settings.support == Support::far_end) {
    std::fill(m.root_columns.begin(), m.root_columns.end(), 0);
  }
  m.weights.resize(static_cast<Eigen::Index>(loads.sets.size()));
  for (Eigen::Index l = 0; l < m.weights.size(); ++l) {
    m.weights(l) = loads.sets[static_cast<std::size_t>(l)].weight;
  }
  m.solved_weights = m.weights;
  m.solved_columns = m.root_columns;
  m.warm_up(loads, section);
  if (settings.loads == LoadDefinition::inertia) {
    m.loads = inertia_loads(loads, m.solver);
  } else {
    m.fixed_loads(loads, section, settings, stiffness0, mass0);
  }
  if (settings.compress) m.compress(settings.compression_tolerance);
}

Compliance::~Compliance() = default;

void Compliance::evaluate(const VectorXd& stiffness, const VectorXd& mass, Value& value) {
  Impl& m = *impl_;
  assert(mass.size() == m.solver.grid().n_cells());
  const double start = cpu_seconds();
  m.factorize(stiffness);
  const double factored = cpu_seconds();
  m.inertia.forces(m.solved(), mass, m.F);
  m.solve_all();
  if (m.held) m.held_at(stiffness);
  const double solved = cpu_seconds();

  m.solver.cell_energies(m.U, m.solved_weights, m.energies, m.solved_columns);
  // 2 F . u - u . K u: equal to F . u at the solution, but round-off in u enters squared.
  value.f = 2 * m.F.cwiseProduct(m.Z).sum() - stiffness.dot(m.energies) -
            m.solver.edge_energy(m.U, m.solved_weights);
  value.d_stiffness = -m.energies;
  if (m.loads.follows_design()) {
    m.inertia.products(m.Z, m.solved().acceleration, m.products);
    value.d_mass = -2 * m.products;
  } else {
    value.d_mass.setZero(m.solver.grid().n_cells());
  }
  if (m.held) m.held->add_to(value);
  if (!std::isfinite(value.f) || !value.d_stiffness.allFinite() || !value.d_mass.allFinite()) {
    throw Error::numerical("compliance: the objective or its derivative is not finite");
  }
  m.seconds = {factored - start, solved - factored, cpu_seconds() - solved};
}

double Compliance::sum(const VectorXd& stiffness, const VectorXd& mass) {
  Impl& m = *impl_;
  if (m.held) return LoadResponse::sum(stiffness, mass);
  m.factorize(stiffness);
  m.inertia.forces(m.solved(), mass, m.F);
  if (m.path == Path::mixed) {
    m.solver.forward(m.F);
  } else {
    m.solver.forward(m.F, m.solved_columns);
  }
  const double out = m.path == Path::mixed ? m.mixed_sum() : m.plain_sum();
  if (!std::isfinite(out)) throw Error::numerical("compliance: the objective is not finite");
  return out;
}

void Compliance::evaluate_each(const VectorXd& stiffness, const VectorXd& mass, Each& each) {
  Impl& m = *impl_;
  const double start = cpu_seconds();
  m.factorize(stiffness);
  const double factored = cpu_seconds();
  m.inertia.forces(m.loads, mass, m.work);
  MatrixXd u = m.work;
  m.solver.solve(u, m.root_columns);
  if (m.held) m.held_at(stiffness);
  const double solved = cpu_seconds();

  each.d_stiffness.resize(u.rows(), stiffness.size());
  each.d_mass.resize(m.loads.follows_design() ? u.rows() : 0, stiffness.size());
  each.f.resize(u.rows());
  const VectorXd one = VectorXd::Ones(1);
  for (Eigen::Index l = 0; l < u.rows(); ++l) {
    m.U = u.row(l);
    m.solver.cell_energies(m.U, one, m.energies,
                           std::span<const int>(&m.root_columns[static_cast<std::size_t>(l)], 1));
    each.f(l) = 2 * m.work.row(l).dot(u.row(l)) - stiffness.dot(m.energies) -
                m.solver.edge_energy(m.U, one);
    each.d_stiffness.row(l) = -m.energies;
    if (!m.loads.follows_design()) continue;
    m.inertia.products(m.U, m.loads.acceleration.row(l), m.products);
    each.d_mass.row(l) = -2 * m.products;
  }
  if (m.held) m.held->add_to(each);
  if (!each.f.allFinite() || !each.d_stiffness.allFinite() || !each.d_mass.allFinite()) {
    throw Error::numerical("compliance: a load's objective or its derivative is not finite");
  }
  m.seconds = {factored - start, solved - factored, cpu_seconds() - solved};
}

int Compliance::factorizations() const { return impl_->factorizations; }

VectorXd Compliance::individual(const VectorXd& stiffness, const VectorXd& mass) {
  Impl& m = *impl_;
  m.factorize(stiffness);
  m.inertia.forces(m.loads, mass, m.work);
  MatrixXd u = m.work;
  m.solver.solve(u, m.root_columns);
  VectorXd compliances = m.work.cwiseProduct(u).rowwise().sum();
  if (m.held) m.held_at(stiffness).add_to(compliances);
  return compliances;
}

void Compliance::Impl::solve_single(int load, const VectorXd& mass, MatrixXd& u) {
  MatrixXd selection = MatrixXd::Zero(1, loads.size());
  selection(0, load) = 1;
  inertia.forces(combine(selection, loads), mass, u);
  solver.solve(u, std::span<const int>(&root_columns[static_cast<std::size_t>(load)], 1));
}

VectorXd Compliance::displacement(const VectorXd& stiffness, const VectorXd& mass, int load) {
  Impl& m = *impl_;
  if (load < 0 || load >= n_loads()) {
    throw Error::input("compliance: load " + std::to_string(load) + " is not one of " +
                       std::to_string(n_loads()));
  }
  m.factorize(stiffness);
  MatrixXd u;
  m.solve_single(load, mass, u);
  const Grid& g = m.solver.grid();
  VectorXd at_nodes = VectorXd::Zero(2 * g.n_nodes());
  for (int i = g.nx; i >= 0 && m.solver.row(i, 0) >= 0; --i) {
    at_nodes.segment(2 * g.node(i, 0), 2 * (g.ny + 1)) =
        u.block(0, m.solver.row(i, 0), 1, 2 * (g.ny + 1)).transpose();
  }
  if (m.held) at_nodes += m.held_at(stiffness).displacement(load);
  if (m.stretch.size() > 0) {
    const double a = m.stretch(load);
    const int root = m.root_columns[static_cast<std::size_t>(load)];
    for (int n = g.node(root, 0); n < g.n_nodes(); ++n)
      at_nodes.segment<2>(2 * n) += a * (g.node_position(n / (g.ny + 1), n % (g.ny + 1)) -
                                         Vec2(g.node_position(root, 0).x(), 0));
  }
  return at_nodes;
}

int Compliance::n_loads() const { return static_cast<int>(impl_->weights.size()); }

int Compliance::n_right_hand_sides() const {
  return static_cast<int>(impl_->solved().size()) + (impl_->held ? impl_->held->n_lines() : 0);
}

double Compliance::condition() const { return impl_->solver.condition(); }
LoadResponse::Seconds Compliance::seconds() const { return impl_->seconds; }

}  // namespace flexmorph::mmc
