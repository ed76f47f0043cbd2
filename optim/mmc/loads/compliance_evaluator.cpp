#include "optim/mmc/loads/compliance_evaluator.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include "geometry/cpu_time.h"
#include "optim/mmc/loads/load_checks.h"
#include "optim/mmc/loads/load_solver.h"
#include "optim/mmc/loads/restrained_expansion.h"

namespace flexmorph::mmc {

namespace {

/// Returns the supports of a link in the solver. For balanced loads any three displacements that
/// prevent rigid motions are suitable; the chosen ones are far apart.
std::array<fem::HeldUnknown, 3> link_supports(const Grid& g, const std::array<int, 2>& pins) {
  const int along = std::abs(pins[1] / (g.ny + 1) - pins[0] / (g.ny + 1)) * g.dx() >=
                            std::abs(pins[1] % (g.ny + 1) - pins[0] % (g.ny + 1)) * g.dy()
                        ? 0
                        : 1;
  return {{{pins[0], 0}, {pins[0], 1}, {pins[1], 1 - along}}};
}

/// Returns the forces of a load by node and value: the last bits of a sum depend on its order.
std::vector<fem::NodalForce> ordered_forces(const LoadCase& load) {
  std::vector<fem::NodalForce> out = load.forces;
  std::ranges::sort(out, {}, [](const fem::NodalForce& f) {
    return std::tuple(f.node, f.force.x(), f.force.y());
  });
  return out;
}

/// Returns the indices of loads sorted by weight, heat and forces.
std::vector<int> order_of(std::span<const LoadCase> loads) {
  std::vector<std::vector<double>> numbers;
  for (const LoadCase& load : loads) {
    std::vector<double>& each = numbers.emplace_back();
    each = {load.weight, load.thermal_stretch};
    for (const fem::NodalForce& f : ordered_forces(load))
      each.insert(each.end(), {static_cast<double>(f.node), f.force.x(), f.force.y()});
  }
  std::vector<int> out(loads.size());
  std::iota(out.begin(), out.end(), 0);
  std::ranges::stable_sort(
      out, {}, [&](int l) -> const auto& { return numbers[static_cast<std::size_t>(l)]; });
  return out;
}

fem::StaticSolver solver_of(const fem::EslSets& sets, const fem::PlaneSection& section,
                            const ComplianceSettings& settings) {
  if (sets.pins) return {sets.grid, section, link_supports(sets.grid, *sets.pins)};
  const std::vector<int> roots = root_columns_of(sets);
  const bool far_end = settings.support == Support::far_end;
  return {sets.grid, section, far_end ? 0 : *std::min_element(roots.begin(), roots.end()),
          edge_stiffness(sets, section)};
}

/// Returns the free thermal expansion of a plate from its root for every load (n x 2 n_nodes) [m],
/// zero behind the root; empty when no load has a thermal stretch.
MatrixXd growth_from_root(const fem::EslSets& sets, std::span<const int> roots) {
  const auto is_hot = [](const fem::EslSet& s) { return s.thermal_stretch != 0; };
  if (std::none_of(sets.sets.begin(), sets.sets.end(), is_hot)) return {};
  const Grid& g = sets.grid;
  MatrixXd out = MatrixXd::Zero(static_cast<Eigen::Index>(roots.size()), 2 * g.n_nodes());
  for (std::size_t l = 0; l < roots.size(); ++l)
    for (int n = g.node(roots[l], 0); n < g.n_nodes(); ++n)
      out.block<1, 2>(static_cast<Eigen::Index>(l), 2 * n) =
          sets.sets[l].thermal_stretch * (g.node_position(n / (g.ny + 1), n % (g.ny + 1)) -
                                          Vec2(g.node_position(roots[l], 0).x(), 0));
  return out;
}

}  // namespace

struct ComplianceEvaluator::Impl : LoadSolver {
  using LoadSolver::LoadSolver;
  std::optional<RestrainedExpansion> restrained;  // present if supports restrain the expansion
  // Free thermal expansion of each load (n x 2 n_nodes) [m]; empty when no load is thermal.
  MatrixXd free_growth;
  bool at_rest = false;
  std::vector<int> positions;  // of the given loads among the sorted ones; empty: not sorted
  VectorXd energies, products;
  Seconds seconds;
};

ComplianceEvaluator::ComplianceEvaluator(const fem::EslSets& loads,
                                         const fem::PlaneSection& section,
                                         const ComplianceSettings& settings,
                                         const VectorXd& stiffness0, const VectorXd& mass0) {
  check_loads(loads, settings, stiffness0, mass0);
  impl_ = std::make_unique<Impl>(solver_of(loads, section, settings), loads.pins.has_value());
  Impl& m = *impl_;
  m.weights.resize(static_cast<Eigen::Index>(loads.sets.size()));
  for (Eigen::Index l = 0; l < m.weights.size(); ++l)
    m.weights(l) = loads.sets[static_cast<std::size_t>(l)].weight;
  if (loads.pins) {
    m.balance.emplace(loads.grid, section, *loads.pins, settings.support);
  } else {
    m.roots = root_columns_of(loads);
    if (settings.support == Support::far_end) std::fill(m.roots.begin(), m.roots.end(), 0);
    m.restrained = restrained_edges(loads, m.solver, m.roots, m.weights);
    m.free_growth = growth_from_root(loads, m.roots);
  }
  m.solved_weights = m.weights;
  m.solved_roots = m.roots;
  if (settings.loads == LoadDefinition::inertia)
    m.loads = inertia_loads(loads, m.inertia.rows());
  else
    m.fix_loads(loads, settings, stiffness0, mass0);
  if (settings.compress) m.compress(settings.compression_tolerance);
}

ComplianceEvaluator::ComplianceEvaluator(const Plate& plate, std::span<const fem::HeldUnknown> held,
                                         std::span<const LoadCase> loads, bool compress,
                                         const Vec2& gravity)
    : impl_(std::make_unique<Impl>(
          fem::StaticSolver(plate.grid, plate.section, held, plate.outside), false)) {
  constexpr double kLeftOut = 1e-10;  // fraction of the energy that compression may leave out
  if (loads.empty()) throw Error::input("static loads: there are no loads");
  Impl& m = *impl_;
  m.at_rest = true;
  if (!gravity.isZero(0)) m.weight.emplace(m.solver, gravity, plate.outside);
  const auto n = static_cast<Eigen::Index>(loads.size());
  m.loads.fixed.setZero(n, m.solver.n_unknowns());
  m.weights.resize(n);
  VectorXd stretch(n);
  const std::vector<int> order = order_of(loads);
  m.positions.resize(loads.size());
  for (Eigen::Index l = 0; l < n; ++l) {
    const int given = order[static_cast<std::size_t>(l)];
    const LoadCase& load = loads[static_cast<std::size_t>(given)];
    m.positions[static_cast<std::size_t>(given)] = static_cast<int>(l);
    check_load(load, plate.grid);
    m.weights(l) = load.weight;
    stretch(l) = load.thermal_stretch;
    for (const fem::NodalForce& f : ordered_forces(load))
      for (int c = 0; c < 2; ++c)
        if (const int row = m.solver.row(f.node, c); row >= 0) m.loads.fixed(l, row) += f.force[c];
    if (m.loads.fixed.row(l).isZero(0) && stretch(l) == 0 && !m.weight)
      refuse(load, "it does not act on any free displacement");
  }
  if (!stretch.isZero(0)) {
    const VectorXd growth = growth_on_supports(m.solver, held);
    m.free_growth = stretch * growth.transpose();
    m.restrained = restrained_supports(m.solver, growth, stretch, m.weights);
    for (Eigen::Index l = 0; l < n && !m.restrained; ++l)
      if (m.loads.fixed.row(l).isZero(0))
        refuse(loads[static_cast<std::size_t>(order[static_cast<std::size_t>(l)])],
               "it consists of heat only, and the supports do not restrain the thermal expansion: "
               "there is no strain");
  }
  m.solved_weights = m.weights;
  // The weight changes with the design, so that loads with weight cannot be compressed in advance.
  if (compress && !m.weight) m.compress(kLeftOut);
}

ComplianceEvaluator::~ComplianceEvaluator() = default;
ComplianceEvaluator::ComplianceEvaluator(ComplianceEvaluator&&) noexcept = default;

void ComplianceEvaluator::evaluate(const VectorXd& stiffness, const VectorXd& mass, Value& value) {
  Impl& m = *impl_;
  assert(mass.size() == m.solver.grid().n_cells());
  const double start = cpu_seconds();
  m.factorize(stiffness);
  const double factored = cpu_seconds();
  const double work = m.solve_sum(m.forces(m.solved(), mass));
  if (m.restrained) m.restrained->update(stiffness);
  const double solved = cpu_seconds();

  m.solver.cell_energies(m.U, m.solved_weights, m.energies, m.solved_roots);
  // 2 F . u - u . K u equals F . u at the solution, but round-off errors of u enter it squared.
  value.f = 2 * work - stiffness.dot(m.energies) - m.solver.edge_energy(m.U, m.solved_weights);
  value.d_stiffness = -m.energies;
  value.d_mass.setZero(mass.size());
  value.d_held.resize(0);
  if (m.loads.follows_design()) {
    if (m.balance) {
      m.inertia.products(m.u_element, m.a_link, m.work);
      m.products = m.work.transpose() * m.solved_weights;
    } else {
      m.inertia.products(m.Z, m.solved().acceleration, m.products);
    }
    value.d_mass = -2 * m.products;
  } else if (m.weight) {
    value.d_mass = 2 * (m.weight->work(m.U).transpose() * m.solved_weights);
  }
  if (m.restrained) m.restrained->add_to(value);
  if (!std::isfinite(value.f) || !value.d_stiffness.allFinite() || !value.d_mass.allFinite())
    throw Error::numerical("compliance: the objective or its derivative is not finite");
  m.seconds = {factored - start, solved - factored, cpu_seconds() - solved};
}

double ComplianceEvaluator::sum(const VectorXd& stiffness, const VectorXd& mass) {
  Impl& m = *impl_;
  if (m.restrained || m.roots.empty()) {
    Value value;
    evaluate(stiffness, mass, value);
    return value.f;
  }
  m.factorize(stiffness);
  const double out = m.forward_sum(mass);
  if (!std::isfinite(out)) throw Error::numerical("compliance: the objective is not finite");
  return out;
}

void ComplianceEvaluator::evaluate_each(const VectorXd& stiffness, const VectorXd& mass,
                                        Each& each) {
  Impl& m = *impl_;
  const double start = cpu_seconds();
  m.factorize(stiffness);
  const double factored = cpu_seconds();
  const MatrixXd& forces = m.forces(m.loads, mass);
  const MatrixXd& u = m.solve(forces, m.roots);
  if (m.restrained) m.restrained->update(stiffness);
  const double solved = cpu_seconds();
  m.solver.cell_energies(m.U, each.d_stiffness);
  each.f = 2 * forces.cwiseProduct(u).rowwise().sum() - each.d_stiffness * stiffness;
  for (Eigen::Index l = 0; l < u.rows() && m.solver.edge_stiffness() > 0; ++l)
    each.f(l) -= m.solver.edge_energy(m.U.row(l), VectorXd::Ones(1));
  each.d_stiffness *= -1;
  each.d_mass.resize(0, 0);
  if (m.loads.follows_design()) {
    m.inertia.products(u, m.balance ? m.a_link : m.loads.acceleration, each.d_mass);
    each.d_mass *= -2;
  } else if (m.weight) {
    each.d_mass = 2 * m.weight->work(u);
  }
  if (m.restrained) m.restrained->add_to(each);
  if (!each.f.allFinite() || !each.d_stiffness.allFinite() || !each.d_mass.allFinite())
    throw Error::numerical("compliance: the objective of a load or its derivative is not finite");
  m.seconds = {factored - start, solved - factored, cpu_seconds() - solved};
}

bool ComplianceEvaluator::has_curvature() const {
  return impl_->at_rest && impl_->free_growth.size() == 0 && !impl_->weight;
}

MatrixXd ComplianceEvaluator::curvature(const VectorXd& stiffness,
                                        const Eigen::SparseMatrix<double>& directions,
                                        const VectorXd& weights) {
  if (!has_curvature()) throw Error::input("these loads have no second derivatives");
  Impl& m = *impl_;
  m.factorize(stiffness);
  const VectorXd& w = weights.size() > 0 ? weights : m.solved_weights;
  m.solve(weights.size() > 0 ? m.loads.fixed : m.solved().fixed, {});
  MatrixXd out = MatrixXd::Zero(directions.cols(), directions.cols());
  for (Eigen::Index l = 0; l < m.U.rows(); ++l) {
    if (w[l] == 0) continue;
    m.solver.cell_forces(m.U.row(l), directions, m.work);
    m.solver.forward(m.work);
    out.selfadjointView<Eigen::Lower>().rankUpdate(m.work, 2 * w[l]);
  }
  return out.selfadjointView<Eigen::Lower>();
}

VectorXd ComplianceEvaluator::individual(const VectorXd& stiffness, const VectorXd& mass) {
  Impl& m = *impl_;
  m.factorize(stiffness);
  const MatrixXd& forces = m.forces(m.loads, mass);
  VectorXd out = forces.cwiseProduct(m.solve(forces, m.roots)).rowwise().sum();
  if (m.restrained) {
    m.restrained->update(stiffness);
    m.restrained->add_to(out);
  }
  return out;
}

VectorXd ComplianceEvaluator::displacement(const VectorXd& stiffness, const VectorXd& mass,
                                           int load) {
  Impl& m = *impl_;
  if (load < 0 || load >= n_loads())
    throw Error::input("compliance: load " + std::to_string(load) + " does not exist; there are " +
                       std::to_string(n_loads()) + " loads");
  m.factorize(stiffness);
  const MatrixXd selection = MatrixXd::Identity(n_loads(), n_loads()).row(load);
  const StaticLoads one = combine(selection, m.loads);
  std::span<const int> root = m.roots;
  if (!root.empty()) root = root.subspan(static_cast<std::size_t>(load), 1);
  MatrixXd out = m.solve(m.forces(one, mass), root);
  if (!m.balance) m.to_nodes(m.U, out);
  if (m.restrained) {
    m.restrained->update(stiffness);
    out += m.restrained->displacement(load).transpose();
  }
  if (m.free_growth.size() > 0) out += m.free_growth.row(load);
  return out.transpose();
}

int ComplianceEvaluator::n_loads() const { return static_cast<int>(impl_->weights.size()); }

int ComplianceEvaluator::position(int load) const {
  return impl_->positions.empty() ? load : impl_->positions[static_cast<std::size_t>(load)];
}

int ComplianceEvaluator::n_right_hand_sides() const {
  return static_cast<int>(impl_->solved().size()) +
         (impl_->restrained ? impl_->restrained->n_lines() : 0);
}

int ComplianceEvaluator::factorizations() const { return impl_->factorizations; }

ComplianceEvaluator::Work ComplianceEvaluator::work() const {
  return {static_cast<std::uint64_t>(impl_->factorizations), impl_->factored_checksum()};
}

void ComplianceEvaluator::continue_from(const Work& work) {
  impl_->factorizations = static_cast<int>(work.factorizations);
  impl_->factored.resize(0);
  impl_->counted = work.factored;
}

double ComplianceEvaluator::condition() const { return impl_->solver.condition(); }
ComplianceEvaluator::Seconds ComplianceEvaluator::seconds() const { return impl_->seconds; }

}  // namespace flexmorph::mmc
