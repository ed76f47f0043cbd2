#include "optim/mmc/mmc_problem.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "geometry/cpu_time.h"
#include "geometry/picture.h"

namespace flexmorph::mmc {

namespace {
/// Mass factor of the weakest cell that still counts as a link between two parts. Half density
/// would be a wall: early designs hang together by less and still carry their loads.
constexpr double kWeakestLink = 0.1;
/// A design without such links that is still less compliant than this many times the best one
/// carries its loads all the same: refusing it would leave the optimizer at a wall.
constexpr double kLargestJump = 3;
/// The bound of a worst case: log z per unit of its variable, and how far it may go.
constexpr double kLogPerUnit = 10, kReachOfBound = 3;
}  // namespace

MmcProblem::MmcProblem(const Grid& grid, const Design& design, const Ersatz& ersatz,
                       LoadResponse& loads, const TdfSettings& tdf, const Goal& goal,
                       std::vector<std::vector<int>> places)
    : grid_(grid),
      design_(design),
      ersatz_(ersatz),
      loads_(loads),
      tdf_(grid, tdf),
      goal_(goal),
      places_(std::move(places)),
      start_(design.x()),
      zero_(VectorXd::Zero(grid.n_cells())),
      share_(VectorXd::Constant(grid.n_cells(), 1.0 / ersatz.n_domain_cells())) {
  if (!bounded()) return;
  solve(start_);
  start_.conservativeResize(start_.size() + 1);
  start_[start_.size() - 1] = std::log(value_.f) / kLogPerUnit;
}

int MmcProblem::n_constraints() const {
  const int n_compliances = goal_.over == Goal::Over::worst ? loads_.n_loads() : 1;
  if (goal_.minimize == Goal::Minimize::volume) return n_compliances;
  return bounded() ? 1 + n_compliances : 1;
}

VectorXd MmcProblem::lower() const {
  VectorXd out = start_;
  out.head(design_.n_variables()) = design_.lower();
  if (bounded()) out[out.size() - 1] -= kReachOfBound;
  return out;
}

VectorXd MmcProblem::upper() const {
  VectorXd out = start_;
  out.head(design_.n_variables()) = design_.upper();
  if (bounded()) out[out.size() - 1] += kReachOfBound;
  return out;
}

/// Fills what the last design was seen to be: factors, volume, compliances.
void MmcProblem::solve(const VectorXd& x) {
  const double clock = cpu_seconds();
  x_ = x;
  design_.components(design_part(x), components_);
  tdf_.evaluate(components_);
  ersatz_.factors(tdf_.density(), tdf_.eroded(), factors_);
  volume_ = factors_.mass.sum() / ersatz_.n_domain_cells();
  seconds_tdf_ += cpu_seconds() - clock;

  if (goal_.over == Goal::Over::sum) {
    loads_.evaluate(factors_.stiffness, factors_.mass, value_);
  } else {
    loads_.evaluate_each(factors_.stiffness, factors_.mass, each_);
    Eigen::Index worst = 0;
    value_.f = each_.f.maxCoeff(&worst);
    value_.d_stiffness = each_.d_stiffness.row(worst);
    if (each_.d_mass.size() > 0)
      value_.d_mass = each_.d_mass.row(worst);
    else
      value_.d_mass = zero_;
  }
  const LoadResponse::Seconds last = loads_.seconds();
  seconds_.factor += last.factor;
  seconds_.solve += last.solve;
  seconds_.sensitivity += last.sensitivity;
  if (!(value_.f > 0) || !std::isfinite(value_.f))
    throw Error::numerical("design problem: the compliance is " + std::to_string(value_.f));
}

/// Derivatives by cell factors -> by the variables of the design, divided by `divisor`.
VectorXd MmcProblem::gradient(const VectorXd& d_stiffness, const VectorXd& d_mass, double divisor) {
  VectorXd out;
  ersatz_.pull_back(tdf_.eroded(), d_stiffness, d_mass, d_h_, d_eroded_);
  tdf_.pull_back(d_h_, d_eroded_, out);
  out /= divisor;
  design_.scale_gradient(out);
  return out;
}

/// log C_l - bound <= 0 of the sum or of every load.
void MmcProblem::fill_compliance_rows(optim::Response& out, int first_row, double bound) {
  const Eigen::Index n = design_.n_variables();
  if (goal_.over == Goal::Over::sum) {
    out.g[first_row] = std::log(value_.f) - bound;
    out.dg.row(first_row).head(n) = gradient(value_.d_stiffness, value_.d_mass, value_.f);
    return;
  }
  for (Eigen::Index l = 0; l < each_.f.size(); ++l) {
    if (!(each_.f[l] > 0))
      throw Error::numerical("design problem: the compliance of load " + std::to_string(l + 1) +
                             " is " + std::to_string(each_.f[l]));
    out.g[first_row + l] = std::log(each_.f[l]) - bound;
  }
  ersatz_.pull_back(tdf_.eroded(), each_.d_stiffness, each_.d_mass, each_by_h_, each_by_eroded_);
  tdf_.pull_back(each_by_h_, each_by_eroded_, each_by_parameters_);
  design_.scale_gradients(each_by_parameters_);
  out.dg.block(first_row, 0, each_.f.size(), n) =
      each_.f.cwiseInverse().asDiagonal() * each_by_parameters_;
}

optim::Response MmcProblem::evaluate(const VectorXd& x) {
  solve(x);
  const double clock = cpu_seconds();
  const Eigen::Index n = design_.n_variables();
  optim::Response out;
  out.df.setZero(n_variables());
  out.g.setZero(n_constraints());
  out.dg.setZero(n_constraints(), n_variables());
  if (goal_.minimize == Goal::Minimize::volume) {
    out.f = volume_;
    out.df = gradient(zero_, share_, 1);
    fill_compliance_rows(out, 0, std::log(goal_.max_compliance));
  } else {
    out.g[0] = volume_ / goal_.max_volume - 1;
    out.dg.row(0).head(n) = gradient(zero_, share_, goal_.max_volume);
    if (bounded()) {
      out.f = kLogPerUnit * x[n];
      out.df[n] = kLogPerUnit;
      fill_compliance_rows(out, 1, out.f);
      out.dg.col(n).tail(loads_.n_loads()).setConstant(-kLogPerUnit);
    } else {
      out.f = std::log(value_.f);
      out.df = gradient(value_.d_stiffness, value_.d_mass, value_.f);
    }
  }
  seconds_tdf_ += cpu_seconds() - clock;
  return out;
}

void MmcProblem::clear_seconds() {
  seconds_tdf_ = 0;
  seconds_ = {};
}

bool MmcProblem::acceptable([[maybe_unused]] const VectorXd& x) {
  assert(x == x_);
  // connectivity() joins cells of half density or more; a link may be weaker on the way.
  const bool holds = connectivity(grid_, 0.5 / kWeakestLink * factors_.mass, places_).connected ||
                     value_.f < kLargestJump * lowest_;
  if (holds) lowest_ = std::min(lowest_, value_.f);
  return holds;
}

}  // namespace flexmorph::mmc
