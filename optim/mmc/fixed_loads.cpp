#include "optim/mmc/fixed_loads.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "geometry/cpu_time.h"
#include "optim/mmc/mmc_problem.h"
#include "optim/mmc/static_loads.h"

namespace flexmorph::mmc {

namespace {

constexpr double kSmall = 1e-12;    // of the growth: round-off of the rigid motion taken off it
constexpr double kLeftOut = 1e-10;  // part of the energy that compression may leave out

void refuse(const LoadCase& load, const std::string& what) {
  throw Error::input("load '" + load.name + "': " + what);
}

/// Does the node belong to a cell of the domain?
bool exists(const Grid& g, std::span<const signed char> outside, int node) {
  const int i = node / (g.ny + 1), j = node % (g.ny + 1);
  for (int ci = std::max(0, i - 1); ci <= std::min(g.nx - 1, i); ++ci)
    for (int cj = std::max(0, j - 1); cj <= std::min(g.ny - 1, j); ++cj)
      if (outside.empty() || outside[static_cast<std::size_t>(g.cell(ci, cj))] == 0) return true;
  return false;
}

/// e + ρ of one unit of growth (2 n_nodes): free growth about the middle of the plate, turned and
/// shifted so that it leaves the held displacements as near to zero as it can.
VectorXd growth_on(std::span<const fem::HeldUnknown> held, const Grid& g) {
  MatrixXd rigid = MatrixXd::Zero(2 * static_cast<Eigen::Index>(g.n_nodes()), 3);
  VectorXd growth(rigid.rows());
  const Vec2 middle(g.x0 + 0.5 * g.width, g.y0 + 0.5 * g.height);
  for (int node = 0; node < g.n_nodes(); ++node) {
    const Vec2 at = g.node_position(node / (g.ny + 1), node % (g.ny + 1)) - middle;
    growth.segment<2>(2 * node) = at;
    rigid.block<2, 3>(2 * node, 0) << 1, 0, -at.y(), 0, 1, at.x();
  }
  MatrixXd rigid_held(static_cast<Eigen::Index>(held.size()), 3);
  VectorXd growth_held(rigid_held.rows());
  for (Eigen::Index k = 0; k < growth_held.size(); ++k) {
    const fem::HeldUnknown& h = held[static_cast<std::size_t>(k)];
    rigid_held.row(k) = rigid.row(2 * h.node + h.component);
    growth_held(k) = growth(2 * h.node + h.component);
  }
  return growth - rigid * rigid_held.completeOrthogonalDecomposition().solve(growth_held);
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
    const double a = load.thermal_stretch;
    if (!(a > -1) || !std::isfinite(a)) refuse(load, "a thermal stretch is a number above -1");
    if (loads_.row(l).isZero(0) && a == 0)
      refuse(load, "nothing of it acts on a displacement that is free");
  }
  warm_up(section, outside, held, loads);
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

/// What there is to know about heat; nothing when all loads are cold.
void FixedLoads::warm_up(const fem::PlaneSection& section, std::span<const signed char> outside,
                         std::span<const fem::HeldUnknown> held, std::span<const LoadCase> loads) {
  const auto is_hot = [](const LoadCase& load) { return load.thermal_stretch != 0; };
  if (std::none_of(loads.begin(), loads.end(), is_hot)) return;
  const Grid& g = solver_.grid();
  const auto n = static_cast<Eigen::Index>(loads.size());
  stretch_.resize(n);
  for (Eigen::Index l = 0; l < n; ++l)
    stretch_(l) = loads[static_cast<std::size_t>(l)].thermal_stretch;

  std::vector<fem::HeldUnknown> there;
  std::copy_if(held.begin(), held.end(), std::back_inserter(there),
               [&](const fem::HeldUnknown& h) { return exists(g, outside, h.node); });
  growth_ = growth_on(there, g);
  MatrixXd prescribed = MatrixXd::Zero(1, growth_.size());
  const double large = g.width + g.height;
  for (const fem::HeldUnknown& h : there) {
    const double left = growth_(2 * h.node + h.component);
    if (std::abs(left) > kSmall * large) prescribed(0, 2 * h.node + h.component) = -left;
  }
  std::vector<int> rows;
  for (int k = 0; k < growth_.size(); ++k) rows.push_back(solver_.row(k / 2, k % 2));
  const bool holds = !prescribed.isZero(0);
  for (Eigen::Index l = 0; l < n && !holds; ++l)
    if (loads_.row(l).isZero(0))
      refuse(loads[static_cast<std::size_t>(l)],
             "heat alone, and the supports let the plate grow: nothing is strained");
  if (!holds) return;
  std::vector<int> lines(loads.size());
  for (std::size_t l = 0; l < loads.size(); ++l) lines[l] = is_hot(loads[l]) ? 0 : -1;
  held_.emplace(HeldExpansion::Plate{g,
                                     section,
                                     std::move(rows),
                                     solver_.n_unknowns(),
                                     std::move(prescribed),
                                     {0},
                                     {outside.begin(), outside.end()}},
                std::move(lines), stretch_, solved_weights_);
}

HeldExpansion& FixedLoads::held_at(const VectorXd& stiffness) {
  held_->update(stiffness, [this](MatrixXd& x) { solver_.solve(x); });
  return *held_;
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
  if (held_) held_at(stiffness);
  const double solved = cpu_seconds();
  solver_.cell_energies(u_, solved_weights_, energies_);
  // 2 F . u - u . K u: equal to F . u at the solution, but round-off in u enters squared.
  value.f = 2 * (solved_weights_.asDiagonal() * solved_).cwiseProduct(u_).sum() -
            stiffness.dot(energies_);
  value.d_stiffness = -energies_;
  value.d_mass.setZero(mass.size());
  if (held_) held_->add_to(value);
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
  if (held_) held_at(stiffness);
  const double solved = cpu_seconds();
  solver_.cell_energies(u_, each.d_stiffness);
  each.f = 2 * loads_.cwiseProduct(u_).rowwise().sum() - each.d_stiffness * stiffness;
  each.d_stiffness *= -1;
  each.d_mass.resize(0, 0);
  if (held_) held_->add_to(each);
  if (!each.f.allFinite() || !each.d_stiffness.allFinite())
    throw Error::numerical("compliance: a load's objective or its derivative is not finite");
  seconds_ = {factored - start, solved - factored, cpu_seconds() - solved};
}

MatrixXd FixedLoads::curvature(const VectorXd& stiffness,
                               const Eigen::SparseMatrix<double>& directions,
                               const VectorXd& weights) {
  if (!has_curvature()) return LoadResponse::curvature(stiffness, directions, weights);
  factorize(stiffness);
  const MatrixXd& loads = weights.size() > 0 ? loads_ : solved_;
  const VectorXd& w = weights.size() > 0 ? weights : solved_weights_;
  u_ = loads;
  solver_.solve(u_);
  MatrixXd out = MatrixXd::Zero(directions.cols(), directions.cols()), forces;
  for (Eigen::Index l = 0; l < loads.rows(); ++l) {
    if (w[l] == 0) continue;
    solver_.cell_forces(u_.row(l), directions, forces);
    solver_.forward(forces);
    out.selfadjointView<Eigen::Lower>().rankUpdate(forces, 2 * w[l]);
  }
  return out.selfadjointView<Eigen::Lower>();
}

VectorXd FixedLoads::individual(const VectorXd& stiffness, const VectorXd& /*mass*/) {
  factorize(stiffness);
  u_ = loads_;
  solver_.solve(u_);
  VectorXd compliances = loads_.cwiseProduct(u_).rowwise().sum();
  if (held_) held_at(stiffness).add_to(compliances);
  return compliances;
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
      if (row >= 0 && stretch_.size() > 0)
        at_nodes[2 * node + c] += stretch_(load) * growth_[2 * node + c];
    }
  if (!held_) return at_nodes;
  const VectorXd thermal = held_at(stiffness).displacement(load);
  for (int k = 0; k < at_nodes.size(); ++k)
    if (solver_.row(k / 2, k % 2) >= 0) at_nodes[k] += thermal[k];
  return at_nodes;
}

}  // namespace flexmorph::mmc
