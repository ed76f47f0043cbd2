#include "tests/benchmark/density_method.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/cpu_time.h"

namespace flexmorph::benchmark {
namespace {

constexpr double kVoid = 1e-6;       // ε
constexpr double kMiddle = 0.5;      // threshold of the projection
constexpr double kLogPerUnit = 10;   // logarithm of the bound per unit of its variable
constexpr double kReachOfBound = 3;  // range of this variable to each side

double projected(double filtered, double beta, double eta) {
  const double below = std::tanh(beta * eta);
  return (below + std::tanh(beta * (filtered - eta))) / (below + std::tanh(beta * (1 - eta)));
}

double d_projected(double filtered, double beta, double eta) {
  const double t = std::tanh(beta * (filtered - eta));
  return beta * (1 - t * t) / (std::tanh(beta * eta) + std::tanh(beta * (1 - eta)));
}

bool lies_in(std::span<const std::vector<Vec2>> polygons, const Vec2& point) {
  return std::any_of(polygons.begin(), polygons.end(), [&](const std::vector<Vec2>& polygon) {
    return contains(Region{polygon, {}}, point);
  });
}

/// Functions are scaled so that the derivative with respect to one cell is of the order of one, for
/// which the constants of the optimizer are chosen.
optim::Settings optimizer_settings(const DensityStage& stage, double move_limit, int n_cells) {
  optim::Settings out;
  out.name = "mma";
  out.max_iterations = stage.iterations;
  out.kkt_tolerance = 0;
  out.rest.rows = 0;
  out.move_limit = move_limit;
  out.feasibility = 1e-4;
  const double scale = n_cells;
  out.options = {{"asyinit", 0.2}, {"asyincr", 1.2}, {"asydecr", 0.7},  {"asymin", 0.01},
                 {"asymax", 1},    {"raa0", 1e-3},   {"fscale", scale}, {"gscale", scale}};
  return out;
}

}  // namespace

DensityPlate density_plate(const mmc::BodyProblem& problem) {
  const mmc::Goal& goal = problem.goal;
  const std::optional<double> volume = mmc::allowed_volume(goal);
  if (!goal.objective->needs_state() || goal.limits.size() != 1 || !volume)
    throw Error::input("the density method knows the least compliance of a volume only");
  DensityPlate out{mmc::plate_of(problem), {}, *volume, goal.objective->per_load};
  const Grid& g = problem.grid;
  for (int i = 0; i < g.nx; ++i)
    for (int j = 0; j < g.ny; ++j) {
      const Vec2 center = g.cell_center(i, j);
      const bool is_void = !out.plate.has(g.cell(i, j)) || lies_in(problem.empty, center);
      const bool is_solid = out.plate.has(g.cell(i, j)) && lies_in(problem.solid, center);
      out.given.push_back(is_solid ? 1 : is_void ? -1 : 0);
    }
  return out;
}

std::vector<DensityStage> density_stages(double threshold) {
  std::vector<DensityStage> out = {{1, 1, 0.5, 80}, {2, 1, 0.5, 80}, {3, 1, 0.5, 160}};
  for (double beta = 2; beta <= 32; beta *= 2) out.push_back({3, beta, threshold, 80});
  return out;
}

Eigen::SparseMatrix<double> density_filter(const mmc::Plate& plate, double radius) {
  const Grid& g = plate.grid;
  const int ni = static_cast<int>(radius / g.dx()), nj = static_cast<int>(radius / g.dy());
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < g.nx; ++i)
    for (int j = 0; j < g.ny; ++j) {
      if (!plate.has(g.cell(i, j))) continue;
      const std::size_t first = entries.size();
      double sum = 0;
      for (int k = std::max(0, i - ni); k <= std::min(g.nx - 1, i + ni); ++k)
        for (int l = std::max(0, j - nj); l <= std::min(g.ny - 1, j + nj); ++l) {
          const double w = radius - (g.cell_center(i, j) - g.cell_center(k, l)).norm();
          if (w <= 0 || !plate.has(g.cell(k, l))) continue;
          entries.emplace_back(g.cell(i, j), g.cell(k, l), w);
          sum += w;
        }
      for (std::size_t e = first; e < entries.size(); ++e)
        entries[e] = {entries[e].row(), entries[e].col(), entries[e].value() / sum};
    }
  Eigen::SparseMatrix<double> out(g.n_cells(), g.n_cells());
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

DensityProblem::DensityProblem(const DensityPlate& plate, const Eigen::SparseMatrix<double>& filter,
                               mmc::ComplianceEvaluator& loads, const DensityStage& stage,
                               VectorXd start)
    : plate_(plate), filter_(filter), loads_(loads), stage_(stage), start_(std::move(start)) {
  for (int c = 0; c < plate.plate.grid.n_cells(); ++c)
    if (plate.designs(c)) designed_.push_back(c);
  if (!plate.worst) return;
  const mmc::CellScaleFactors cells = factors(densities(start_));
  const double largest = loads.individual(cells.stiffness, cells.mass).maxCoeff();
  start_.conservativeResize(start_.size() + 1);
  start_[start_.size() - 1] = std::log(largest) / kLogPerUnit;
}

VectorXd DensityProblem::lower() const {
  VectorXd out = VectorXd::Zero(start_.size());
  if (plate_.worst) out[n_designed()] = start_[n_designed()] - kReachOfBound;
  return out;
}

VectorXd DensityProblem::upper() const {
  VectorXd out = VectorXd::Ones(start_.size());
  if (plate_.worst) out[n_designed()] = start_[n_designed()] + kReachOfBound;
  return out;
}

Densities DensityProblem::densities(const VectorXd& x) const {
  const int n = plate_.plate.grid.n_cells();
  VectorXd all = VectorXd::Zero(n);
  for (int c = 0; c < n; ++c) all[c] = plate_.given[static_cast<std::size_t>(c)] > 0;
  for (std::size_t k = 0; k < designed_.size(); ++k)
    all[designed_[k]] = x[static_cast<Eigen::Index>(k)];
  Densities out{filter_ * all, VectorXd::Zero(n), VectorXd::Zero(n)};
  for (int c = 0; c < n; ++c) {
    if (plate_.designs(c)) {
      out.projected[c] = projected(out.filtered[c], stage_.projection, kMiddle);
      out.stiff[c] = projected(out.filtered[c], stage_.projection, stage_.threshold);
    } else {
      out.projected[c] = out.stiff[c] = out.filtered[c] =
          plate_.given[static_cast<std::size_t>(c)] > 0;
    }
  }
  return out;
}

mmc::CellScaleFactors DensityProblem::factors(const Densities& at) const {
  return {kVoid + (1 - kVoid) * at.stiff.array().pow(stage_.penalty), at.projected};
}

/// Returns derivatives with respect to the variables from derivatives with respect to the scale
/// factors of cells. @param d_mass  empty means zero
VectorXd DensityProblem::slope(const Densities& at, const VectorXd& d_stiffness,
                               const VectorXd& d_mass) const {
  VectorXd by_filtered = VectorXd::Zero(at.projected.size());
  for (const int c : designed_) {
    const double x = at.filtered[c];
    if (d_mass.size() > 0) by_filtered[c] += d_mass[c] * d_projected(x, stage_.projection, kMiddle);
    if (d_stiffness.size() > 0)
      by_filtered[c] += d_stiffness[c] * (1 - kVoid) * stage_.penalty *
                        std::pow(at.stiff[c], stage_.penalty - 1) *
                        d_projected(x, stage_.projection, stage_.threshold);
  }
  const VectorXd by_all = filter_.transpose() * by_filtered;
  VectorXd out = VectorXd::Zero(start_.size());
  for (std::size_t k = 0; k < designed_.size(); ++k)
    out[static_cast<Eigen::Index>(k)] = by_all[designed_[k]];
  return out;
}

/// Adds the objective, and log C_l <= log z if the largest compliance is minimized.
void DensityProblem::add_loads(const Densities& at, const mmc::CellScaleFactors& cells,
                               double bound, optim::ProblemValues& out) {
  if (!plate_.worst) {
    mmc::ComplianceEvaluator::Value value;
    loads_.evaluate(cells.stiffness, cells.mass, value);
    out.f = std::log(value.f);
    out.df = slope(at, value.d_stiffness, value.d_mass) / value.f;
    return;
  }
  mmc::ComplianceEvaluator::Each each;
  loads_.evaluate_each(cells.stiffness, cells.mass, each);
  out.f = kLogPerUnit * bound;
  out.df = VectorXd::Zero(start_.size());
  out.df[n_designed()] = kLogPerUnit;
  for (Eigen::Index l = 0; l < each.f.size(); ++l) {
    out.g[1 + l] = std::log(each.f[l]) - kLogPerUnit * bound;
    const VectorXd d_mass = each.d_mass.size() > 0 ? VectorXd(each.d_mass.row(l)) : VectorXd();
    out.dg.row(1 + l) = slope(at, each.d_stiffness.row(l), d_mass).transpose() / each.f[l];
    out.dg(1 + l, n_designed()) = -kLogPerUnit;
  }
}

optim::ProblemValues DensityProblem::evaluate(const VectorXd& x) {
  const Densities at = densities(x);
  optim::ProblemValues out;
  out.g = VectorXd::Zero(n_constraints());
  out.dg = MatrixXd::Zero(n_constraints(), start_.size());
  const double allowed = plate_.volume * plate_.plate.n_domain_cells();
  out.g[0] = at.projected.sum() / allowed - 1;
  out.dg.row(0) = slope(at, {}, VectorXd::Constant(at.projected.size(), 1 / allowed)).transpose();
  add_loads(at, factors(at), plate_.worst ? x[n_designed()] : 0, out);
  return out;
}

std::vector<DensityDesign> design_by_densities(const DensityPlate& plate,
                                               mmc::ComplianceEvaluator& loads,
                                               const DensitySettings& settings) {
  const double clock = cpu_seconds();
  const Eigen::SparseMatrix<double> filter =
      density_filter(plate.plate, settings.radius * plate.plate.grid.dx());
  const auto count = [&](signed char kind) {
    return static_cast<double>(std::count(plate.given.begin(), plate.given.end(), kind));
  };
  const double even = (plate.volume * plate.plate.n_domain_cells() - count(1)) / count(0);
  VectorXd x = VectorXd::Constant(static_cast<Eigen::Index>(count(0)), even);
  std::vector<DensityDesign> out;
  for (const DensityStage& stage : settings.stages) {
    DensityProblem problem(plate, filter, loads, stage, x);
    const optim::Settings chosen =
        optimizer_settings(stage, settings.move_limit, plate.plate.n_domain_cells());
    const optim::Result found = optim::make_optimizer(chosen)->minimize(problem, {});
    x = found.x.head(problem.n_designed());
    const int before = out.empty() ? 0 : out.back().iterations;
    const double compliance =
        std::exp(plate.worst ? kLogPerUnit * found.x[x.size()] : found.response.f);
    out.push_back({stage, problem.densities(x), compliance, before + found.iterations,
                   cpu_seconds() - clock});
  }
  return out;
}

}  // namespace flexmorph::benchmark
