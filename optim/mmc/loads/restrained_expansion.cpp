#include "optim/mmc/loads/restrained_expansion.h"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cassert>
#include <compare>
#include <cstddef>
#include <utility>

#include "fem/solve/q4_cell.h"

namespace flexmorph::mmc {

namespace {

std::array<int, 8> entries_of(const Grid& g, int i, int j) {
  std::array<int, 8> out{};
  for (std::size_t a = 0; a < 4; ++a) {
    out[2 * a] = 2 * g.node(i + fem::kCornerI[a], j + fem::kCornerJ[a]);
    out[2 * a + 1] = out[2 * a] + 1;
  }
  return out;
}

}  // namespace

RestrainedExpansion::RestrainedExpansion(const fem::StaticSolver& solver, Lines lines,
                                         const VectorXd& weights)
    : solver_(&solver), lines_(std::move(lines)) {
  assert(std::is_sorted(lines_.root_columns.begin(), lines_.root_columns.end()));
  line_weights_.setZero(n_lines());
  for (Eigen::Index l = 0; l < weights.size(); ++l)
    if (const int line = line_of(l); line >= 0)
      line_weights_(line) += weights(l) * lines_.growth(l) * lines_.growth(l);
  const Grid& g = solver_->grid();
  for (int cell = 0; cell < g.n_cells(); ++cell) {
    if (!solver_->has_cell(cell)) continue;
    const auto entries = entries_of(g, cell / g.ny, cell % g.ny);
    if (std::any_of(entries.begin(), entries.end(),
                    [this](int e) { return !lines_.held.col(e).isZero(0); }))
      touched_.push_back(cell);
  }
}

/// Computes the right-hand sides -K_fc τ_c - κ Bᵀd. Cells behind a clamped line contribute nothing,
/// because all of their nodes are held.
void RestrainedExpansion::forces(const VectorXd& stiffness) {
  const Grid& g = solver_->grid();
  const auto K = fem::q4_stiffness(solver_->section(), g.dx(), g.dy());
  forces_.setZero(n_lines(), solver_->n_unknowns());
  for (const int cell : touched_) {
    const auto entries = entries_of(g, cell / g.ny, cell % g.ny);
    for (std::size_t a = 0; a < 8; ++a) {
      const int row = solver_->rows()[static_cast<std::size_t>(entries[a])];
      if (row < 0) continue;
      for (std::size_t b = 0; b < 8; ++b)
        forces_.col(row) -= stiffness(cell) *
                            K(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) *
                            lines_.held.col(entries[b]);
    }
  }
  if (!holds_end()) return;
  // d is uniform; therefore the forces of adjacent springs cancel except at both ends of the edge.
  const VectorXd kappa_d = solver_->edge_stiffness() * g.dy() * lines_.end_stretch;
  forces_.col(solver_->row(g.node(g.nx, 0), 1)) += kappa_d;
  forces_.col(solver_->row(g.node(g.nx, g.ny), 1)) -= kappa_d;
}

/// Computes the energies τ . K_cell τ of cells of full material, without cells behind a clamped
/// line.
void RestrainedExpansion::line_energies() {
  const Grid& g = solver_->grid();
  const fem::Q4Energy energy(solver_->section(), g.dx(), g.dy());
  const VectorXd ones = VectorXd::Ones(n_lines());
  energies_.setZero(n_lines(), g.n_cells());
  const std::vector<int>& roots = lines_.root_columns;
  for (int i = 0; i < g.nx; ++i) {
    const Eigen::Index n =
        roots.empty() ? n_lines() : std::upper_bound(roots.begin(), roots.end(), i) - roots.begin();
    for (int j = 0; n > 0 && j < g.ny; ++j) {
      if (!solver_->has_cell(g.cell(i, j))) continue;
      const auto entries = entries_of(g, i, j);
      fem::Q4Energy::Corners x;
      for (std::size_t a = 0; a < 4; ++a) {
        x.u[a] = tau_.col(entries[2 * a]).data();
        x.v[a] = tau_.col(entries[2 * a + 1]).data();
      }
      energy.weighted(x, ones.data(), n, energies_.col(g.cell(i, j)).data());
    }
  }
}

/// Adds the energies κ |B τ + d|² of the springs at the far edge.
void RestrainedExpansion::add_edge_energies() {
  const Grid& g = solver_->grid();
  const int first = 2 * g.node(g.nx, 0), last = 2 * g.node(g.nx, g.ny);
  const auto difference = [&](int entry) { return tau_.col(entry + 2) - tau_.col(entry); };
  const VectorXd mean = (tau_.col(last) - tau_.col(first)) / g.ny;
  const VectorXd d = g.dy() * lines_.end_stretch;
  for (int entry = first; entry < last; entry += 2)
    compliances_ += solver_->edge_stiffness() * ((difference(entry) - mean).cwiseAbs2() +
                                                 (difference(entry + 1) + d).cwiseAbs2());
}

void RestrainedExpansion::update(const VectorXd& stiffness) {
  if (stiffness_.size() == stiffness.size() && stiffness_ == stiffness) return;
  stiffness_.resize(0);
  forces(stiffness);
  if (holds_end() || lines_.root_columns.empty())
    solver_->solve(forces_, lines_.root_columns);
  else
    solver_->solve_at_clamp(forces_, lines_.root_columns);
  tau_ = lines_.held;
  for (Eigen::Index e = 0; e < tau_.cols(); ++e) {
    const int row = solver_->rows()[static_cast<std::size_t>(e)];
    if (row >= 0) tau_.col(e) += forces_.col(row);
  }
  line_energies();
  compliances_ = energies_ * stiffness;
  if (holds_end()) add_edge_energies();
  if (!compliances_.allFinite())
    throw Error::numerical(
        "compliance: the energy of the restrained thermal expansion is not finite");
  stiffness_ = stiffness;
}

void RestrainedExpansion::add_to(ComplianceEvaluator::Value& value) const {
  value.f += line_weights_.dot(compliances_);
  value.d_held.noalias() = energies_.transpose() * line_weights_;
  value.d_stiffness += value.d_held;
}

void RestrainedExpansion::add_to(ComplianceEvaluator::Each& each) const {
  add_to(each.f);
  for (Eigen::Index l = 0; l < each.f.size(); ++l)
    if (const int line = line_of(l); line >= 0)
      each.d_stiffness.row(l) += lines_.growth(l) * lines_.growth(l) * energies_.row(line);
}

void RestrainedExpansion::add_to(VectorXd& compliances) const {
  for (Eigen::Index l = 0; l < compliances.size(); ++l)
    if (const int line = line_of(l); line >= 0)
      compliances(l) += lines_.growth(l) * lines_.growth(l) * compliances_(line);
}

VectorXd RestrainedExpansion::displacement(int load) const {
  const int line = line_of(load);
  if (line < 0) return VectorXd::Zero(tau_.cols());
  return lines_.growth(load) * tau_.row(line).transpose();
}

void RestrainedExpansion::take_from(MatrixXd& u) const {
  for (Eigen::Index l = 0; l < u.rows(); ++l) {
    if (line_of(l) < 0) continue;
    for (Eigen::Index e = 0; e < tau_.cols(); ++e)
      if (const int row = solver_->rows()[static_cast<std::size_t>(e)]; row >= 0)
        u(l, row) -= lines_.growth(l) * tau_(line_of(l), e);
  }
}

double edge_stiffness(const fem::EslSets& sets, const fem::PlaneSection& section) {
  if (std::none_of(sets.sets.begin(), sets.sets.end(),
                   [](const fem::EslSet& s) { return s.held_end_stretch != 0; }))
    return 0;
  const Grid& g = sets.grid;
  return 1e3 * section.youngs_modulus * section.thickness * g.height / g.dy();
}

namespace {

/// The restraint of a load: the root line in `column` if `root` is true, and the far edge with the
/// stretch `end` relative to the restrained expansion g of the load.
struct HeldLine {
  int column = 0;
  bool root = false;
  double end = 0;
  auto operator<=>(const HeldLine&) const = default;
};

}  // namespace

std::optional<RestrainedExpansion> restrained_edges(const fem::EslSets& sets,
                                                    const fem::StaticSolver& solver,
                                                    std::span<const int> columns,
                                                    const VectorXd& weights) {
  RestrainedExpansion::Lines out;
  std::vector<HeldLine> of_loads, lines;
  out.growth.resize(weights.size());
  for (std::size_t l = 0; l < columns.size(); ++l) {
    const double g = sets.sets[l].held_stretch, g_e = sets.sets[l].held_end_stretch;
    const double growth = out.growth(static_cast<Eigen::Index>(l)) = g != 0 ? g : g_e;
    of_loads.push_back({columns[l], g != 0, growth != 0 ? g_e / growth : 0});
    if (growth != 0) lines.push_back(of_loads.back());
  }
  if (lines.empty()) return {};
  std::sort(lines.begin(), lines.end());
  lines.erase(std::unique(lines.begin(), lines.end()), lines.end());
  for (std::size_t l = 0; l < columns.size(); ++l) {
    const auto line = std::lower_bound(lines.begin(), lines.end(), of_loads[l]) - lines.begin();
    out.of_load.push_back(out.growth(static_cast<Eigen::Index>(l)) != 0 ? static_cast<int>(line)
                                                                        : -1);
  }
  const Grid& g = sets.grid;
  const auto n = static_cast<Eigen::Index>(lines.size());
  out.held.setZero(n, 2 * g.n_nodes());
  VectorXd end(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const HeldLine& line = lines[static_cast<std::size_t>(k)];
    out.root_columns.push_back(line.column);
    end(k) = line.end;
    for (int j = 0; line.root && j <= g.ny; ++j)
      out.held(k, 2 * g.node(line.column, j) + 1) = -g.node_position(line.column, j).y();
  }
  if (!end.isZero(0)) out.end_stretch = end;
  return RestrainedExpansion(solver, std::move(out), weights);
}

namespace {

/// Returns true if a node belongs to a cell of the domain.
bool exists(const fem::StaticSolver& solver, int node) {
  const Grid& g = solver.grid();
  const int i = node / (g.ny + 1), j = node % (g.ny + 1);
  for (int ci = std::max(0, i - 1); ci <= std::min(g.nx - 1, i); ++ci)
    for (int cj = std::max(0, j - 1); cj <= std::min(g.ny - 1, j); ++cj)
      if (solver.has_cell(g.cell(ci, cj))) return true;
  return false;
}

}  // namespace

VectorXd growth_on_supports(const fem::StaticSolver& solver,
                            std::span<const fem::HeldUnknown> held) {
  constexpr double kRoundOff =
      1e-12;  // round-off of the rigid motion, relative to the plate's size
  const Grid& g = solver.grid();
  MatrixXd rigid = MatrixXd::Zero(2 * static_cast<Eigen::Index>(g.n_nodes()), 3);
  VectorXd growth(rigid.rows());
  const Vec2 middle(g.x0 + 0.5 * g.width, g.y0 + 0.5 * g.height);
  for (int node = 0; node < g.n_nodes(); ++node) {
    const Vec2 at = g.node_position(node / (g.ny + 1), node % (g.ny + 1)) - middle;
    growth.segment<2>(2 * node) = at;
    rigid.block<2, 3>(2 * node, 0) << 1, 0, -at.y(), 0, 1, at.x();
  }
  std::vector<Eigen::Index> there;
  for (const fem::HeldUnknown& h : held)
    if (exists(solver, h.node)) there.push_back(2 * h.node + h.component);
  growth -= rigid * MatrixXd(rigid(there, Eigen::all))
                        .completeOrthogonalDecomposition()
                        .solve(VectorXd(growth(there)));
  for (int k = 0; k < growth.size(); ++k) {
    const bool negligible = std::abs(growth(k)) <= kRoundOff * (g.width + g.height);
    if (solver.row(k / 2, k % 2) < 0 && (negligible || !exists(solver, k / 2))) growth(k) = 0;
  }
  return growth;
}

std::optional<RestrainedExpansion> restrained_supports(const fem::StaticSolver& solver,
                                                       const VectorXd& growth,
                                                       const VectorXd& stretch,
                                                       const VectorXd& weights) {
  RestrainedExpansion::Lines lines;
  lines.held.setZero(1, growth.size());
  for (int k = 0; k < growth.size(); ++k)
    if (solver.row(k / 2, k % 2) < 0) lines.held(0, k) = -growth(k);
  if (lines.held.isZero(0)) return {};
  for (const double a : stretch) lines.of_load.push_back(a != 0 ? 0 : -1);
  lines.growth = stretch;
  return RestrainedExpansion(solver, std::move(lines), weights);
}

}  // namespace flexmorph::mmc
