#include "optim/mmc/mmc_problem.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <ctime>

#include "geometry/outline.h"

namespace flexmorph::mmc {

namespace {
/// Mass factor of the weakest cell that still counts as a link between two parts. Half density
/// would be a wall: early designs hang together by less and still carry their loads.
constexpr double kWeakestLink = 0.1;
/// A design without such links that is still less compliant than this many times the best one
/// carries its loads all the same: refusing it would leave the optimizer at a wall.
constexpr double kLargestJump = 3;
}  // namespace

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

MmcProblem::MmcProblem(const Grid& grid, const Design& design, const Ersatz& ersatz,
                       Compliance& compliance, const TdfSettings& tdf, double max_volume)
    : grid_(grid),
      design_(design),
      ersatz_(ersatz),
      compliance_(compliance),
      tdf_(grid, tdf),
      max_volume_(max_volume),
      zero_(VectorXd::Zero(grid.n_cells())),
      ones_(VectorXd::Constant(grid.n_cells(), 1.0 / grid.n_cells())) {}

optim::Response MmcProblem::evaluate(const VectorXd& x) {
  double clock = cpu_seconds();
  x_ = x;
  design_.components(x, components_);
  tdf_.evaluate(components_);
  ersatz_.factors(tdf_.density(), tdf_.eroded(), factors_);
  volume_ = factors_.mass.mean();
  seconds_tdf_ = cpu_seconds() - clock;

  compliance_.evaluate(factors_.stiffness, factors_.mass, value_);
  seconds_ = compliance_.seconds();
  if (!(value_.f > 0) || !std::isfinite(value_.f))
    throw Error::numerical("design problem: the compliance is " + std::to_string(value_.f));

  clock = cpu_seconds();
  optim::Response out;
  out.f = std::log(value_.f);
  ersatz_.pull_back(tdf_.eroded(), value_.d_stiffness, value_.d_mass, d_h_, d_eroded_);
  tdf_.pull_back(d_h_, d_eroded_, d_x_);
  out.df = d_x_ / value_.f;
  design_.scale_gradient(out.df);
  out.g.setConstant(1, volume_ / max_volume_ - 1);
  ersatz_.pull_back(tdf_.eroded(), zero_, ones_, d_h_, d_eroded_);
  tdf_.pull_back(d_h_, d_eroded_, d_x_);
  d_x_ /= max_volume_;
  design_.scale_gradient(d_x_);
  out.dg = d_x_.transpose();
  seconds_tdf_ += cpu_seconds() - clock;
  return out;
}

bool MmcProblem::acceptable([[maybe_unused]] const VectorXd& x) {
  assert(x == x_);
  // connectivity() joins cells of half density or more; a link may be weaker on the way.
  const bool holds = connectivity(grid_, 0.5 / kWeakestLink * factors_.mass).connected ||
                     value_.f < kLargestJump * lowest_;
  if (holds) lowest_ = std::min(lowest_, value_.f);
  return holds;
}

}  // namespace flexmorph::mmc
