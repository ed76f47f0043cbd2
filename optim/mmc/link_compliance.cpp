#include "optim/mmc/link_compliance.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "fem/solve/plate_solver.h"
#include "geometry/cpu_time.h"
#include "optim/mmc/link_balance.h"
#include "optim/mmc/load_checks.h"
#include "optim/mmc/static_loads.h"

namespace flexmorph::mmc {
namespace {

[[noreturn]] void refuse(const std::string& what) {
  throw Error::input("equivalent static loads of a link: " + what);
}

void check_link(const fem::EslSets& loads, const ComplianceSettings& settings) {
  if (!loads.pins) refuse("they have no pins");
  if (!is_of_link(settings.support))
    refuse("a link has no root that 'moving_root' or 'far_end' could hold: 'pins' or 'floating'");
  if (settings.loads == LoadDefinition::stiffness)
    refuse("definition 'stiffness' is for plates with a root: 'inertia' or 'frozen'");
  for (const fem::EslSet& set : loads.sets)
    if (set.root_column != 0 || set.thermal_stretch != 0)
      refuse("a root column or heat, which links do not have");
  for (const int pin : *loads.pins)
    if (pin < 0 || pin >= loads.grid.n_nodes()) refuse("a pin is at no node of the grid");
}

/// What keeps the plate while it is solved for: any three displacements do for balanced loads,
/// these are far apart.
std::array<fem::HeldUnknown, 3> any_hold(const Grid& g, const std::array<int, 2>& pins) {
  const int along = std::abs(pins[1] / (g.ny + 1) - pins[0] / (g.ny + 1)) * g.dx() >=
                            std::abs(pins[1] % (g.ny + 1) - pins[0] % (g.ny + 1)) * g.dy()
                        ? 0
                        : 1;
  return {{{pins[0], 0}, {pins[0], 1}, {pins[1], 1 - along}}};
}

}  // namespace

struct LinkCompliance::Impl {
  fem::PlateSolver solver;
  LinkBalance balance;
  bool follows = true;  // loads follow the design
  /// Right-hand sides: a and f, or F where loads are frozen (n x 2 n_nodes).
  struct Loads {
    MatrixXd acceleration, forces;
  };
  Loads loads, solved;  // all of them; what evaluate() solves
  VectorXd weights, solved_weights, factored;
  MatrixXd F, a, u, unknowns;  // reused by every evaluation
  VectorXd energies, products;
  Seconds seconds;
  int factorizations = 0;

  Impl(const fem::EslSets& sets, const fem::PlaneSection& section, Support support)
      : solver(sets.grid, section, any_hold(sets.grid, *sets.pins)),
        balance(sets.grid, section, *sets.pins, support) {}

  void read(const fem::EslSets& sets);
  void factorize(const VectorXd& stiffness);
  void balanced(const Loads& of, const VectorXd& mass);
  void solve();
  void compress(double tolerance);
};

void LinkCompliance::Impl::read(const fem::EslSets& sets) {
  const auto n = static_cast<Eigen::Index>(sets.sets.size());
  weights.resize(n);
  loads.acceleration.resize(n, 2 * sets.grid.n_nodes());
  loads.forces = MatrixXd::Zero(n, loads.acceleration.cols());
  for (Eigen::Index l = 0; l < n; ++l) {
    const fem::EslSet& set = sets.sets[static_cast<std::size_t>(l)];
    weights(l) = set.weight;
    loads.acceleration.row(l) = set.acceleration.transpose();
    for (const fem::NodalForce& f : set.forces)
      loads.forces.block<1, 2>(l, 2 * f.node) += f.force.transpose();
  }
}

void LinkCompliance::Impl::factorize(const VectorXd& stiffness) {
  if (factored.size() == stiffness.size() && factored == stiffness) return;
  factored.resize(0);
  ++factorizations;
  solver.factorize(stiffness);
  factored = stiffness;
}

/// F, and a + R c in `a`.
void LinkCompliance::Impl::balanced(const Loads& of, const VectorXd& mass) {
  if (!follows) {
    F = of.forces;
    return;
  }
  balance.set_mass(mass);
  a = of.acceleration;
  balance.inertia_forces(a, F);
  F += of.forces;
  balance.balance(F, a);
}

/// F -> u in all nodes, the one that LinkBalance means.
void LinkCompliance::Impl::solve() {
  const Eigen::Index n = F.rows();
  unknowns.resize(n, solver.n_unknowns());
  for (int k = 0; k < F.cols(); ++k)
    if (const int row = solver.row(k / 2, k % 2); row >= 0) unknowns.col(row) = F.col(k);
  solver.solve(unknowns);
  u.setZero(n, F.cols());
  for (int k = 0; k < F.cols(); ++k)
    if (const int row = solver.row(k / 2, k % 2); row >= 0) u.col(k) = unknowns.col(row);
  balance.choose(u);
}

/// All loads share one support, so that f depends on Σ w F Fᵀ only, and F is linear in (a, f)
/// whatever the design. Directions are chosen by the energies of the full plate.
void LinkCompliance::Impl::compress(double tolerance) {
  const Eigen::Index n = weights.size();
  const VectorXd full = VectorXd::Ones(solver.grid().n_cells()), roots = weights.cwiseSqrt();
  factorize(full);
  balanced(loads, full);
  MatrixXd y(n, solver.n_unknowns());
  for (int k = 0; k < F.cols(); ++k)
    if (const int row = solver.row(k / 2, k % 2); row >= 0)
      y.col(row) = roots.cwiseProduct(F.col(k));
  solver.forward(y);
  const MatrixXd U = leading_combinations(y, tolerance);
  if (U.cols() >= n) return;
  const MatrixXd mix = U.transpose() * roots.asDiagonal();
  if (follows) solved.acceleration = mix * loads.acceleration;
  solved.forces = mix * loads.forces;
  solved_weights = VectorXd::Ones(U.cols());
}

LinkCompliance::LinkCompliance(const fem::EslSets& loads, const fem::PlaneSection& section,
                               const ComplianceSettings& settings, const VectorXd& stiffness0,
                               const VectorXd& mass0) {
  check_loads(loads, settings, stiffness0, mass0);
  check_link(loads, settings);
  impl_ = std::make_unique<Impl>(loads, section, settings.support);
  Impl& m = *impl_;
  m.read(loads);
  if (settings.loads == LoadDefinition::frozen) {
    m.balanced(m.loads, mass0);
    m.loads = {{}, m.F};
    m.follows = false;
  }
  m.solved = m.loads;
  m.solved_weights = m.weights;
  if (settings.compress) m.compress(settings.compression_tolerance);
}

LinkCompliance::~LinkCompliance() = default;

void LinkCompliance::evaluate(const VectorXd& stiffness, const VectorXd& mass, Value& value) {
  Impl& m = *impl_;
  const double start = cpu_seconds();
  m.factorize(stiffness);
  const double factored = cpu_seconds();
  m.balanced(m.solved, mass);
  m.solve();
  const double solved = cpu_seconds();
  m.solver.cell_energies(m.unknowns, m.solved_weights, m.energies);
  // 2 F . u - u . K u: equal to F . u at the solution, but round-off in u enters squared.
  value.f =
      2 * (m.solved_weights.asDiagonal() * m.F).cwiseProduct(m.u).sum() - stiffness.dot(m.energies);
  value.d_stiffness = -m.energies;
  value.d_mass.setZero(mass.size());
  value.d_held.resize(0);
  if (m.follows) {
    m.balance.products(m.u, m.a, m.solved_weights, m.products);
    value.d_mass = -2 * m.products;
  }
  if (!std::isfinite(value.f) || !value.d_stiffness.allFinite() || !value.d_mass.allFinite())
    throw Error::numerical("compliance: the objective or its derivative is not finite");
  m.seconds = {factored - start, solved - factored, cpu_seconds() - solved};
}

void LinkCompliance::evaluate_each(const VectorXd& stiffness, const VectorXd& mass, Each& each) {
  Impl& m = *impl_;
  const double start = cpu_seconds();
  m.factorize(stiffness);
  const double factored = cpu_seconds();
  m.balanced(m.loads, mass);
  m.solve();
  const double solved = cpu_seconds();
  m.solver.cell_energies(m.unknowns, each.d_stiffness);
  each.f = 2 * m.F.cwiseProduct(m.u).rowwise().sum() - each.d_stiffness * stiffness;
  each.d_stiffness *= -1;
  each.d_mass.resize(0, 0);
  if (m.follows) {
    m.balance.products(m.u, m.a, each.d_mass);
    each.d_mass *= -2;
  }
  if (!each.f.allFinite() || !each.d_stiffness.allFinite() || !each.d_mass.allFinite())
    throw Error::numerical("compliance: a load's objective or its derivative is not finite");
  m.seconds = {factored - start, solved - factored, cpu_seconds() - solved};
}

VectorXd LinkCompliance::individual(const VectorXd& stiffness, const VectorXd& mass) {
  Impl& m = *impl_;
  m.factorize(stiffness);
  m.balanced(m.loads, mass);
  m.solve();
  return m.F.cwiseProduct(m.u).rowwise().sum();
}

VectorXd LinkCompliance::displacement(const VectorXd& stiffness, const VectorXd& mass, int load) {
  Impl& m = *impl_;
  if (load < 0 || load >= n_loads())
    throw Error::input("compliance: load " + std::to_string(load) + " is not one of " +
                       std::to_string(n_loads()));
  m.factorize(stiffness);
  m.balanced(
      {m.follows ? MatrixXd(m.loads.acceleration.row(load)) : MatrixXd(), m.loads.forces.row(load)},
      mass);
  m.solve();
  return m.u.row(0);
}

int LinkCompliance::n_loads() const { return static_cast<int>(impl_->weights.size()); }
int LinkCompliance::n_right_hand_sides() const {
  return static_cast<int>(impl_->solved_weights.size());
}
int LinkCompliance::factorizations() const { return impl_->factorizations; }
double LinkCompliance::condition() const { return impl_->solver.condition(); }
LoadResponse::Seconds LinkCompliance::seconds() const { return impl_->seconds; }

std::unique_ptr<LoadResponse> make_compliance(const fem::EslSets& loads,
                                              const fem::PlaneSection& section,
                                              const ComplianceSettings& settings,
                                              const VectorXd& stiffness0, const VectorXd& mass0) {
  if (is_of_link(settings.support))
    return std::make_unique<LinkCompliance>(loads, section, settings, stiffness0, mass0);
  return std::make_unique<Compliance>(loads, section, settings, stiffness0, mass0);
}

}  // namespace flexmorph::mmc
