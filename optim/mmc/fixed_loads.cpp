#include "optim/mmc/fixed_loads.h"

#include <cmath>

#include "optim/mmc/mmc_problem.h"
#include "optim/mmc/static_loads.h"

namespace flexmorph::mmc {

namespace {

constexpr double kLeftOut = 1e-10;  // part of the energy that compression may leave out

void refuse(const LoadCase& load, const std::string& what) {
  throw Error::input("load '" + load.name + "': " + what);
}

}  // namespace

FixedLoads::FixedLoads(const Grid& grid, const fem::PlaneSection& section,
                       std::span<const signed char> outside, std::span<const fem::HeldUnknown> held,
                       std::span<const LoadCase> loads, bool compress)
    : solver_(grid, section, held, outside) {
  if (loads.empty()) throw Error::input("static loads: there are none");
  const auto n = static_cast<Eigen::Index>(loads.size());
  loads_.setZero(n, solver_.n_unknowns());
  solved_weights_.resize(n);
  for (Eigen::Index l = 0; l < n; ++l) {
    const LoadCase& load = loads[static_cast<std::size_t>(l)];
    if (!(load.weight > 0) || !std::isfinite(load.weight)) refuse(load, "a weight is positive");
    solved_weights_(l) = load.weight;
    for (const fem::NodalForce& f : load.forces) {
      if (f.node < 0 || f.node >= grid.n_nodes() || !f.force.allFinite())
        refuse(load, "a force is not finite or has no node");
      for (int c = 0; c < 2; ++c) {
        const int row = solver_.row(f.node, c);
        if (row >= 0) loads_(l, row) += f.force[c];
      }
    }
    if (loads_.row(l).isZero(0)) refuse(load, "nothing of it acts on a displacement that is free");
  }
  solved_ = loads_;
  if (!compress || n == 1) return;
  factorize(VectorXd::Ones(grid.n_cells()));
  const VectorXd roots = solved_weights_.cwiseSqrt();
  MatrixXd y = roots.asDiagonal() * loads_;
  solver_.forward(y);
  const MatrixXd U = leading_combinations(y, kLeftOut);
  if (U.cols() >= n) return;
  solved_ = U.transpose() * (roots.asDiagonal() * loads_);
  solved_weights_ = VectorXd::Ones(U.cols());
}

void FixedLoads::factorize(const VectorXd& stiffness) {
  if (factored_.size() == stiffness.size() && factored_ == stiffness) return;
  factored_.resize(0);
  ++factorizations_;
  solver_.factorize(stiffness);
  factored_ = stiffness;
}

void FixedLoads::evaluate(const VectorXd& stiffness, const VectorXd& mass, Value& value) {
  const double start = cpu_seconds();
  factorize(stiffness);
  const double factored = cpu_seconds();
  u_ = solved_;
  solver_.solve(u_);
  const double solved = cpu_seconds();
  solver_.cell_energies(u_, solved_weights_, energies_);
  // 2 F . u - u . K u: equal to F . u at the solution, but round-off in u enters squared.
  value.f = 2 * (solved_weights_.asDiagonal() * solved_).cwiseProduct(u_).sum() -
            stiffness.dot(energies_);
  value.d_stiffness = -energies_;
  value.d_mass.setZero(mass.size());
  if (!std::isfinite(value.f) || !value.d_stiffness.allFinite())
    throw Error::numerical("compliance: the objective or its derivative is not finite");
  seconds_ = {factored - start, solved - factored, cpu_seconds() - solved};
}

void FixedLoads::evaluate_each(const VectorXd& stiffness, const VectorXd& /*mass*/, Each& each) {
  const double start = cpu_seconds();
  factorize(stiffness);
  const double factored = cpu_seconds();
  u_ = loads_;
  solver_.solve(u_);
  const double solved = cpu_seconds();
  solver_.cell_energies(u_, each.d_stiffness);
  each.f = 2 * loads_.cwiseProduct(u_).rowwise().sum() - each.d_stiffness * stiffness;
  each.d_stiffness *= -1;
  each.d_mass.resize(0, 0);
  if (!each.f.allFinite() || !each.d_stiffness.allFinite())
    throw Error::numerical("compliance: a load's objective or its derivative is not finite");
  seconds_ = {factored - start, solved - factored, cpu_seconds() - solved};
}

VectorXd FixedLoads::individual(const VectorXd& stiffness, const VectorXd& /*mass*/) {
  factorize(stiffness);
  u_ = loads_;
  solver_.solve(u_);
  return loads_.cwiseProduct(u_).rowwise().sum();
}

VectorXd FixedLoads::displacement(const VectorXd& stiffness, const VectorXd& /*mass*/, int load) {
  if (load < 0 || load >= n_loads())
    throw Error::input("compliance: load " + std::to_string(load) + " is not one of " +
                       std::to_string(n_loads()));
  factorize(stiffness);
  MatrixXd u = loads_.row(load);
  solver_.solve(u);
  VectorXd at_nodes = VectorXd::Zero(2 * solver_.grid().n_nodes());
  for (int node = 0; node < solver_.grid().n_nodes(); ++node)
    for (int c = 0; c < 2; ++c) {
      const int row = solver_.row(node, c);
      if (row >= 0) at_nodes[2 * node + c] = u(0, row);
    }
  return at_nodes;
}

}  // namespace flexmorph::mmc
