#include "optim/mmc/problem/mmc_problem.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "geometry/cpu_time.h"
#include "geometry/parts/picture.h"
#include "optim/mmc/problem/crisp_picture.h"
#include "optim/mmc/problem/motion_response.h"

namespace flexmorph::mmc {

namespace {
/// Smallest mass factor of a cell that counts as a connection between two regions [-]. Half density
/// would be too strict, because early designs are connected by less and still carry their loads.
constexpr double kWeakestLink = 0.1;
/// A design without such connections carries its loads nevertheless if its compliance is less than
/// this multiple of that of uniform material. If it were refused, the optimizer could not proceed.
constexpr double kMaxCompliance = 2;
/// The variable that bounds an objective with one value per load, relative to the largest value of
/// the start: its logarithm per unit of the variable, and the largest size of the variable.
constexpr double kLogPerUnit = 10, kReachOfBound = 3;
}  // namespace

MmcProblem::MmcProblem(const DesignedPlate& plate, const TdfSettings& tdf, Goal goal,
                       std::vector<HeldOrLoaded> locations)
    : plate_(plate.plate),
      design_(plate.design),
      ersatz_(plate.ersatz),
      state_(plate.loads),
      shape_(plate.shape),
      motion_(plate.motion),
      crisp_(plate.crisp),
      limited_(plate.limited),
      tdf_(plate_.grid, tdf),
      goal_(std::move(goal)),
      locations_(std::move(locations)),
      start_(design_.x()),
      zero_(VectorXd::Zero(plate_.grid.n_cells())) {
  for (const ResponseRow* row : rows_of(goal_))
    entries_.push_back({row, row->make(plate_), {}, {}, {}, {}});
  if (!bounded()) return;
  solve(start_);
  start_.conservativeResize(start_.size() + 1);
  bound_unit_ = entries_.front().values.f.maxCoeff();
  start_[start_.size() - 1] = 0;
}

int MmcProblem::row_of(size_t limit) const {
  int row = 0;
  for (size_t k = 0; k < limit; ++k) row += count(*goal_.limits[k].row);
  return row;
}

int MmcProblem::n_constraints() const {
  return row_of(goal_.limits.size()) + (bounded() ? count(*goal_.objective) : 0) +
         (shape_ ? shape_->count() : 0);
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

const MmcProblem::Entry& MmcProblem::entry(const ResponseRow& row) const {
  const auto found =
      std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.row == &row; });
  assert(found != entries_.end());
  return *found;
}

std::optional<VectorXd> MmcProblem::values(const ResponseRow& row) const {
  for (const Entry& e : entries_)
    if (e.row == &row) return e.values.f;
  return {};
}

void MmcProblem::look(const VectorXd& x) {
  const double clock = cpu_seconds();
  x_ = x;
  design_.components(design_part(x), components_);
  if (crisp_) {
    factors_ = ersatz_.crisp(crisp_->fractions(components_));
    crisp_gradient_ =
        std::make_unique<const Eigen::SparseMatrix<double>>(crisp_->slopes(components_));
  } else {
    tdf_.evaluate(components_);
    ersatz_.factors(tdf_.density(), tdf_.eroded(), factors_);
  }
  volume_ = factors_.mass.sum() / ersatz_.n_domain_cells();
  seconds_tdf_ += cpu_seconds() - clock;
  solved_ = differentiated_ = false;
  if (motion_) motion_->state->notify(motion_->body, factors_);
}

/// Computes the scale factors, the volume and the values of all responses at a design.
void MmcProblem::solve(const VectorXd& x) {
  look(x);
  state_.begin();
  const DesignView seen{factors_, components_, state_, motion_};
  for (Entry& e : entries_) e.response->evaluate(seen, e.values);
  solved_ = true;
}

void MmcProblem::restore(const VectorXd& x) {
  x_ = x;
  design_.components(design_part(x), components_);
  solved_ = differentiated_ = false;
}

MatrixXd MmcProblem::pull_back_crisp(const MatrixXd& d_stiffness, const MatrixXd& d_mass) const {
  MatrixXd by_fraction = ersatz_.crisp_stiffness_derivative() * d_stiffness;
  if (d_mass.size() > 0) by_fraction += d_mass;
  return by_fraction * *crisp_gradient_;
}

/// Converts the derivatives by scale factors and component parameters: for a response with one
/// value into derivatives by component parameters, for one value per load into those by design
/// variables.
void MmcProblem::pull_back(Entry& e) {
  const Values& v = e.values;
  if (e.row->per_load) {
    if (crisp_) {
      e.slopes = pull_back_crisp(v.d_stiffness, v.d_mass);
    } else {
      ersatz_.pull_back(tdf_.eroded(), v.d_stiffness, v.d_mass, many_by_h_, many_by_eroded_);
      tdf_.pull_back(many_by_h_, many_by_eroded_, e.slopes);
    }
    if (v.d_parameters.size() > 0) e.slopes += v.d_parameters;
    design_.scale_gradients(e.slopes);
    return;
  }
  const auto or_zero = [&](const MatrixXd& d, VectorXd& copy) -> const VectorXd& {
    if (d.size() == 0) return zero_;
    return copy = d.row(0);
  };
  const VectorXd &d_stiffness = or_zero(v.d_stiffness, d_stiffness_),
                 &d_mass = or_zero(v.d_mass, d_mass_);
  if (crisp_) {
    e.slope = pull_back_crisp(d_stiffness.transpose(), d_mass.transpose()).transpose();
  } else {
    ersatz_.pull_back(tdf_.eroded(), d_stiffness, d_mass, d_h_, d_eroded_);
    tdf_.pull_back(d_h_, d_eroded_, e.slope);
  }
  if (v.d_parameters.size() > 0) e.slope += v.d_parameters.row(0).transpose();
}

/// Returns the gradient of a response with one value by the design variables, divided by `divisor`.
VectorXd MmcProblem::gradient(const Entry& e, double divisor) const {
  VectorXd out = e.slope;
  out /= divisor;
  design_.scale_gradient(out);
  return out;
}

VectorXd MmcProblem::pull_back_scale_factors(const CellScaleFactors& d_factors) {
  VectorXd out;
  if (crisp_) {
    out = pull_back_crisp(d_factors.stiffness.transpose(), d_factors.mass.transpose()).transpose();
  } else {
    ersatz_.pull_back(tdf_.eroded(), d_factors.stiffness, d_factors.mass, d_h_, d_eroded_);
    tdf_.pull_back(d_h_, d_eroded_, out);
  }
  design_.scale_gradient(out);
  return out;
}

/// Adds the constraints log f_l - bound <= 0 of a response with one value per load.
void MmcProblem::add_each(const Entry& e, double unit, int first_row,
                          optim::ProblemValues& out) const {
  const Eigen::Index n = design_.n_variables(), m = e.values.f.size();
  for (Eigen::Index l = 0; l < m; ++l) out.g[first_row + l] = std::log(e.values.f[l] / unit);
  out.dg.block(first_row, 0, m, n) = e.values.f.cwiseInverse().asDiagonal() * e.slopes;
}

void MmcProblem::add_limit(const Limit& limit, int first_row, optim::ProblemValues& out) const {
  const Entry& e = entry(*limit.row);
  const Eigen::Index n = design_.n_variables();
  const VectorXd& f = e.values.f;
  if (limit.row->per_load) {
    add_each(e, limit.value, first_row, out);
    if (e.crisp)
      out.g.segment(first_row, f.size()) = (e.crisp->array() / limit.value).log().matrix();
  } else if (limit.row->full) {
    const double part =
        (limit.volume && shape_ ? outline_.volume / *limit.volume : f[0] / limit.value);
    out.g[first_row] = part - 1;
    out.dg.row(first_row).head(n) = gradient(e, f[0] / part);
  } else {
    out.g[first_row] = std::log((e.crisp ? *e.crisp : f)[0] / limit.value);
    out.dg.row(first_row).head(n) = gradient(e, f[0]);
  }
  if (!limit.at_least) return;
  out.g.segment(first_row, count(*limit.row)) *= -1;
  out.dg.middleRows(first_row, count(*limit.row)) *= -1;
}

void MmcProblem::add_objective(optim::ProblemValues& out) const {
  const Entry& e = entries_.front();
  if (bounded()) {
    const Eigen::Index n = design_.n_variables();
    const int first_row = row_of(goal_.limits.size());
    const double bound = kLogPerUnit * x_[n];
    out.f = std::log(bound_unit_) + bound;
    out.df[n] = kLogPerUnit;
    add_each(e, bound_unit_, first_row, out);
    out.g.segment(first_row, e.values.f.size()).array() -= bound;
    out.dg.col(n).segment(first_row, e.values.f.size()).setConstant(-kLogPerUnit);
    out.first_bound = first_row;
    out.n_bounds = e.values.f.size();
  } else if (const double f = e.values.f[0]; e.row->full) {
    const double full = e.row->full(plate_);
    out.f = f / full;
    out.df = gradient(e, full);
  } else {
    out.f = std::log(f);
    out.df = gradient(e, f);
  }
}

void MmcProblem::add_shape(optim::ProblemValues& out) {
  const Eigen::Index m = outline_.g.size();
  design_.scale_gradients(outline_.dg);
  out.g.tail(m) = outline_.g;
  out.dg.bottomLeftCorner(m, outline_.dg.cols()) = outline_.dg;
}

optim::ProblemValues MmcProblem::evaluate(const VectorXd& x) {
  solve(x);
  const double clock = cpu_seconds();
  for (Entry& e : entries_) pull_back(e);
  differentiated_ = true;
  optim::ProblemValues out;
  out.df.setZero(n_variables());
  out.g.setZero(n_constraints());
  out.dg.setZero(n_constraints(), n_variables());
  if (shape_) shape_->evaluate(components_, outline_);
  if (limited_) analyse_limits();
  for (size_t k = 0; k < goal_.limits.size(); ++k) add_limit(goal_.limits[k], row_of(k), out);
  add_objective(out);
  if (shape_) add_shape(out);
  seconds_tdf_ += cpu_seconds() - clock;
  return out;
}

/// Computes the values of limited responses of the loads for the crisp design.
void MmcProblem::analyse_limits() {
  DesignState state(state_.loads());
  const CellScaleFactors factors = ersatz_.crisp(limited_->of_part(components_));
  const DesignView seen{factors, components_, state, motion_};
  for (const Limit& limit : goal_.limits) {
    if (!limit.row->needs_state() || limit.row->of_motion) continue;
    for (Entry& e : entries_) {
      if (e.row != limit.row) continue;
      Values values;
      e.response->evaluate(seen, values);
      e.crisp = values.f;
    }
  }
}

bool MmcProblem::has_curvature() const {
  if (shape_ || crisp_ || limited_) return false;
  return tdf_.settings().kind == TdfSettings::Kind::distance &&
         std::all_of(entries_.begin(), entries_.end(), [&](const Entry& e) {
           return e.row->linear || (e.row->needs_state() && state_.loads().has_curvature());
         });
}

/// Adds the weighted values of a response, or of their logarithms, to the Lagrangian.
void MmcProblem::add_row(const Entry& e, const VectorXd& weights, bool logarithm,
                         Lagrangian& out) const {
  const Eigen::Index n = design_.n_variables();
  VectorXd w = weights;
  if (logarithm) {
    w = weights.cwiseQuotient(e.values.f);
    for (Eigen::Index l = 0; l < w.size(); ++l) {
      const VectorXd slope =
          e.row->per_load ? VectorXd(e.slopes.row(l) / e.values.f[l]) : gradient(e, e.values.f[l]);
      out.outer.topLeftCorner(n, n) -= weights[l] * slope * slope.transpose();
    }
  }
  if (e.values.d_stiffness.size() > 0) out.d_stiffness += e.values.d_stiffness.transpose() * w;
  if (e.values.d_mass.size() > 0) out.d_mass += e.values.d_mass.transpose() * w;
  if (!e.row->needs_state()) return;
  if (e.row->per_load)
    out.of_each = out.of_each.size() > 0 ? VectorXd(out.of_each + w) : w;
  else
    out.of_sum += w[0];
}

MatrixXd MmcProblem::curvature(const VectorXd& x, double sigma, const VectorXd& lambda) {
  if (!differentiated_ || x.size() != x_.size() || x != x_) evaluate(x);
  const Eigen::Index n = design_.n_variables();
  Lagrangian sum{zero_, zero_, 0, {}, MatrixXd::Zero(n_variables(), n_variables())};
  for (size_t k = 0; k < goal_.limits.size(); ++k) {
    const Limit& limit = goal_.limits[k];
    const Entry& e = entry(*limit.row);
    const bool logarithm = limit.row->per_load || limit.row->full == nullptr;
    const double sign = limit.at_least ? -1 : 1;
    add_row(e, sign / (logarithm ? 1 : limit.value) * lambda.segment(row_of(k), count(*limit.row)),
            logarithm, sum);
  }
  const Entry& e = entries_.front();
  if (bounded())
    add_row(e, lambda.tail(e.values.f.size()), true, sum);
  else
    add_row(e, VectorXd::Constant(1, e.row->full ? sigma / e.row->full(plate_) : sigma),
            e.row->full == nullptr, sum);

  UnionTdf::NodeGradients f;
  ersatz_.pull_back(tdf_.eroded(), sum.d_stiffness, sum.d_mass, f.df_dh, f.df_deroded);
  f.d2f_deroded2 = ersatz_.twice(sum.d_stiffness);
  const Eigen::SparseMatrix<double> slopes = tdf_.slopes();
  MatrixXd own = tdf_.curvature(f, slopes);
  if (sum.of_sum != 0 || sum.of_each.size() > 0) {
    const Eigen::SparseMatrix<double> directions =
        ersatz_.stiffness_gradient(tdf_.eroded()) * (tdf_.eroded_gradient().asDiagonal() * slopes);
    ComplianceEvaluator& loads = state_.loads();
    if (sum.of_sum != 0) own += sum.of_sum * loads.curvature(factors_.stiffness, directions, {});
    if (sum.of_each.size() > 0) own += loads.curvature(factors_.stiffness, directions, sum.of_each);
  }
  design_.scale_gradients(own);
  own.transposeInPlace();
  design_.scale_gradients(own);
  sum.outer.topLeftCorner(n, n) += own;
  return sum.outer;
}

void MmcProblem::clear_seconds() {
  seconds_tdf_ = 0;
  state_.clear_seconds();
}

bool MmcProblem::acceptable([[maybe_unused]] const VectorXd& x) {
  assert(x == x_);
  // connectivity() joins cells of at least half density, but intermediate designs may be connected
  // by cells of lower density: the mass factors are scaled up accordingly.
  return connectivity(plate_.grid, 0.5 / kWeakestLink * factors_.mass, locations_).connected ||
         (std::isfinite(compliance()) && compliance() < kMaxCompliance * uniform_compliance());
}

/// Returns the compliance of uniform material of the allowed volume, for comparison with designs.
/// Its factorization is not counted, because every call of a resumed run repeats it.
double MmcProblem::uniform_compliance() {
  if (uniform_) return *uniform_;
  constexpr double kHalf = 0.5;  // volume fraction where no limit bounds the volume
  const VectorXd even =
      VectorXd::Constant(plate_.grid.n_cells(), allowed_volume(goal_).value_or(kHalf));
  ComplianceEvaluator& loads = state_.loads();
  const ComplianceEvaluator::Work counted = loads.work();
  uniform_ = compliance_row(goal_).per_load ? loads.individual(even, even).maxCoeff()
                                            : loads.sum(even, even);
  loads.continue_from(counted);
  return *uniform_;
}

}  // namespace flexmorph::mmc
