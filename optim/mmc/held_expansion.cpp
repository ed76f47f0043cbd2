#include "optim/mmc/held_expansion.h"

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

HeldExpansion::HeldExpansion(Plate plate, std::vector<int> lines, const VectorXd& growth,
                             const VectorXd& weights)
    : plate_(std::move(plate)), lines_(std::move(lines)), growth_(growth) {
  assert(std::is_sorted(plate_.first_columns.begin(), plate_.first_columns.end()));
  line_weights_.setZero(n_lines());
  for (std::size_t l = 0; l < lines_.size(); ++l) {
    const auto at = static_cast<Eigen::Index>(l);
    if (lines_[l] >= 0) line_weights_(lines_[l]) += weights(at) * growth_(at) * growth_(at);
  }
  const Grid& g = plate_.grid;
  if (plate_.outside.empty()) plate_.outside.assign(static_cast<std::size_t>(g.n_cells()), 0);
  for (int cell = 0; cell < g.n_cells(); ++cell) {
    if (plate_.outside[static_cast<std::size_t>(cell)]) continue;
    const auto entries = entries_of(g, cell / g.ny, cell % g.ny);
    if (std::any_of(entries.begin(), entries.end(),
                    [this](int e) { return !plate_.held.col(e).isZero(0); }))
      touched_.push_back(cell);
  }
}

/// -K_fc τ_c - κ Bᵀd. Cells behind a line reach only nodes that it holds.
void HeldExpansion::forces(const VectorXd& stiffness) {
  const Grid& g = plate_.grid;
  const auto K = fem::q4_stiffness(plate_.section, g.dx(), g.dy());
  forces_.setZero(n_lines(), plate_.n_unknowns);
  for (const int cell : touched_) {
    const auto entries = entries_of(g, cell / g.ny, cell % g.ny);
    for (std::size_t a = 0; a < 8; ++a) {
      const int row = plate_.rows[static_cast<std::size_t>(entries[a])];
      if (row < 0) continue;
      for (std::size_t b = 0; b < 8; ++b)
        forces_.col(row) -= stiffness(cell) *
                            K(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) *
                            plate_.held.col(entries[b]);
    }
  }
  if (!holds_end()) return;
  // d is the same everywhere: what neighbours have in common is no load.
  const VectorXd kappa_d = plate_.edge_stiffness * g.dy() * plate_.end_stretch;
  const auto row = [&](int j) {
    return plate_.rows[static_cast<std::size_t>(2 * g.node(g.nx, j) + 1)];
  };
  forces_.col(row(0)) += kappa_d;
  forces_.col(row(g.ny)) -= kappa_d;
}

/// τ . K_cell τ of full material; nothing behind a line.
void HeldExpansion::line_energies() {
  const Grid& g = plate_.grid;
  const fem::Q4Energy energy(plate_.section, g.dx(), g.dy());
  const VectorXd ones = VectorXd::Ones(n_lines());
  energies_.setZero(n_lines(), g.n_cells());
  for (int i = plate_.first_columns.front(); i < g.nx; ++i) {
    const auto end = std::upper_bound(plate_.first_columns.begin(), plate_.first_columns.end(), i);
    const Eigen::Index n = end - plate_.first_columns.begin();
    for (int j = 0; j < g.ny; ++j) {
      if (plate_.outside[static_cast<std::size_t>(g.cell(i, j))]) continue;
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

/// κ |B τ + d|²
void HeldExpansion::add_edge_energies() {
  const Grid& g = plate_.grid;
  const int first = 2 * g.node(g.nx, 0), last = 2 * g.node(g.nx, g.ny);
  const auto difference = [&](int entry) { return tau_.col(entry + 2) - tau_.col(entry); };
  const VectorXd mean = (tau_.col(last) - tau_.col(first)) / g.ny;
  const VectorXd d = g.dy() * plate_.end_stretch;
  for (int entry = first; entry < last; entry += 2)
    compliances_ += plate_.edge_stiffness * ((difference(entry) - mean).cwiseAbs2() +
                                             (difference(entry + 1) + d).cwiseAbs2());
}

void HeldExpansion::update(const VectorXd& stiffness, const fem::StaticSolver& solver) {
  update(stiffness, [&](MatrixXd& x) {
    if (holds_end())
      solver.solve(x, plate_.first_columns);
    else
      solver.solve_at_clamp(x, plate_.first_columns);
  });
}

void HeldExpansion::update(const VectorXd& stiffness, const Solve& solve) {
  if (stiffness_.size() == stiffness.size() && stiffness_ == stiffness) return;
  stiffness_.resize(0);
  forces(stiffness);
  solve(forces_);
  tau_ = plate_.held;
  for (Eigen::Index e = 0; e < tau_.cols(); ++e) {
    const int row = plate_.rows[static_cast<std::size_t>(e)];
    if (row >= 0) tau_.col(e) += forces_.col(row);
  }
  line_energies();
  compliances_ = energies_ * stiffness;
  if (holds_end()) add_edge_energies();
  if (!compliances_.allFinite())
    throw Error::numerical("compliance: the energy of the held thermal growth is not finite");
  stiffness_ = stiffness;
}

void HeldExpansion::add_to(LoadResponse::Value& value) const {
  value.f += line_weights_.dot(compliances_);
  value.d_held.noalias() = energies_.transpose() * line_weights_;
  value.d_stiffness += value.d_held;
}

void HeldExpansion::add_to(LoadResponse::Each& each) const {
  add_to(each.f);
  for (std::size_t l = 0; l < lines_.size(); ++l) {
    const auto at = static_cast<Eigen::Index>(l);
    if (lines_[l] >= 0)
      each.d_stiffness.row(at) += growth_(at) * growth_(at) * energies_.row(lines_[l]);
  }
}

void HeldExpansion::add_to(VectorXd& compliances) const {
  for (std::size_t l = 0; l < lines_.size(); ++l) {
    const auto at = static_cast<Eigen::Index>(l);
    if (lines_[l] >= 0) compliances(at) += growth_(at) * growth_(at) * compliances_(lines_[l]);
  }
}

VectorXd HeldExpansion::displacement(int load) const {
  const int line = lines_[static_cast<std::size_t>(load)];
  if (line < 0) return VectorXd::Zero(tau_.cols());
  return growth_(load) * tau_.row(line).transpose();
}

void HeldExpansion::take_from(MatrixXd& u) const {
  for (std::size_t l = 0; l < lines_.size(); ++l) {
    if (lines_[l] < 0) continue;
    const auto load = static_cast<Eigen::Index>(l);
    for (Eigen::Index e = 0; e < tau_.cols(); ++e) {
      const int row = plate_.rows[static_cast<std::size_t>(e)];
      if (row >= 0) u(load, row) -= growth_(load) * tau_(lines_[l], e);
    }
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

/// What loads hold: the root line in `column` (or not), and the far edge by `end` times as much.
struct Edges {
  int column = 0;
  bool root = false;
  double end = 0;
  auto operator<=>(const Edges&) const = default;
};

/// g τ of a load is growth * τ of these edges.
struct EdgesOfLoad {
  double growth = 0;
  Edges edges;

  EdgesOfLoad(const fem::EslSet& set, int column) : edges{column, set.held_stretch != 0, 0} {
    const double g = set.held_stretch, g_e = set.held_end_stretch;
    growth = edges.root ? g : g_e;
    if (growth != 0) edges.end = g_e / growth;
  }
};

/// @param lines  distinct edges, by column
HeldExpansion::Plate plate_of(const Grid& g, const fem::PlaneSection& section,
                              const fem::StaticSolver& solver, std::span<const Edges> lines,
                              double edge_stiffness) {
  HeldExpansion::Plate plate;
  plate.grid = g;
  plate.section = section;
  plate.n_unknowns = solver.n_unknowns();
  const auto n = static_cast<Eigen::Index>(lines.size());
  plate.held.setZero(n, 2 * g.n_nodes());
  VectorXd end(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const Edges& line = lines[static_cast<std::size_t>(k)];
    plate.first_columns.push_back(line.column);
    end(k) = line.end;
    for (int j = 0; line.root && j <= g.ny; ++j)
      plate.held(k, 2 * g.node(line.column, j) + 1) = -g.node_position(line.column, j).y();
  }
  if (!end.isZero(0)) {
    plate.edge_stiffness = edge_stiffness;
    plate.end_stretch = end;
  }
  for (int i = 0; i <= g.nx; ++i)
    for (int j = 0; j <= g.ny; ++j) {
      const int row = solver.row(i, j);
      plate.rows.push_back(row);
      plate.rows.push_back(row < 0 ? -1 : row + 1);
    }
  return plate;
}

}  // namespace

std::optional<HeldExpansion> held_edges(const fem::EslSets& sets, const fem::PlaneSection& section,
                                        const fem::StaticSolver& solver,
                                        std::span<const int> columns, const VectorXd& weights) {
  std::vector<EdgesOfLoad> loads;
  std::vector<Edges> lines;
  VectorXd growth(weights.size());
  for (std::size_t l = 0; l < columns.size(); ++l) {
    loads.emplace_back(sets.sets[l], columns[l]);
    growth(static_cast<Eigen::Index>(l)) = loads.back().growth;
    if (loads.back().growth != 0) lines.push_back(loads.back().edges);
  }
  if (lines.empty()) return {};
  std::sort(lines.begin(), lines.end());
  lines.erase(std::unique(lines.begin(), lines.end()), lines.end());

  std::vector<int> line_of(columns.size(), -1);
  for (std::size_t l = 0; l < columns.size(); ++l)
    if (loads[l].growth != 0)
      line_of[l] = static_cast<int>(std::lower_bound(lines.begin(), lines.end(), loads[l].edges) -
                                    lines.begin());
  return HeldExpansion(plate_of(sets.grid, section, solver, lines, edge_stiffness(sets, section)),
                       std::move(line_of), growth, weights);
}

}  // namespace flexmorph::mmc
