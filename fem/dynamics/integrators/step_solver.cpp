#include "fem/dynamics/integrators/step_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "fem/dynamics/force_balance.h"
#include "fem/solve/condition.h"
#include "fem/solve/scaled_constraints.h"
#include "geometry/text.h"

namespace flexmorph::fem {
namespace {

// Ratio of error and allowed error below which slow contraction does not prevent a growth of the
// step.
constexpr double kMaxChange = 0.1;
// Largest correction of a predicted position of rigid bodies, relative to the predicted motion or
// to kPartOfSize of the model if that is larger. A larger correction may lead to another branch.
constexpr double kCorrection = 0.1, kPartOfSize = 0.2;
// Fraction of a step below which a position where branches meet is passed, see
// BranchWatch::refusal().
constexpr double kCrossing = 1.0 / 64;

}  // namespace

StepSolver::StepSolver(Workspace& model, const StepSettings& settings, std::string name,
                       std::string advice)
    : model_(model),
      settings_(settings),
      name_(std::move(name)),
      advice_(std::move(advice)),
      branch_(model) {
  if (!(settings.tolerance > 0) || settings.max_iterations < 1 || settings.max_halvings < 0)
    throw Error::input(
        name_ +
        ": tolerance and max_iterations must be positive, and max_halvings must not be negative");
}

void StepSolver::set_scales() {
  if (scaled_version_ == model_.pattern_version()) return;
  scales_ = model_.scales();
  size_ = undeformed_size(model_, scales_);
  rigid_dofs_.clear();
  for (const Body& b : model_.bodies())
    if (b.element->is_rigid())
      for (int k = 0; k < b.n_dofs(); ++k) rigid_dofs_.push_back(b.first_dof + k);
  scaled_version_ = model_.pattern_version();
}

/// Unknown i is scaled to the displacement scales_i Δq_i, and its equation to the virtual work on
/// it.
void StepSolver::scale_kkt(const std::vector<char>& chosen) {
  const auto is_chosen = [&](int k) { return chosen.empty() || chosen[static_cast<size_t>(k)]; };
  for (int column = 0; column < kkt_.cols(); ++column) {
    if (!is_chosen(column)) continue;
    for (SparseMatrix::InnerIterator entry(kkt_, column); entry; ++entry) {
      if (!is_chosen(static_cast<int>(entry.row()))) continue;
      if (column < model_.n_dofs()) entry.valueRef() /= scales_[column];
      if (entry.row() < model_.n_dofs()) entry.valueRef() /= scales_[entry.row()];
    }
  }
}

void StepSolver::factorize(double miss) {
  set_scales();
  scale_kkt({});
  if (analysed_version_ != model_.pattern_version()) {
    solver_.analyze(kkt_);
    analysed_version_ = model_.pattern_version();
  }
  solver_.factorize(kkt_, miss);
  ++counts_.factorizations;
}

std::optional<double> StepSolver::condition() const {
  if (counts_.factorizations == 0) return {};
  return condition_estimate(solver_.as_solved(kkt_));
}

void StepSolver::factorize_here(double h) {
  // A tenth of the contraction that Newton's method accepts for a kept tangent.
  constexpr double kFactorError = 0.02;
  tangent(kkt_);
  factorize(kFactorError);
  factored_h_ = h;
  if (!solver_.border().empty()) turns_.begin(model_, iterate());
}

void StepSolver::renew_border() {
  const std::vector<char>& border = solver_.border();
  if (border.empty() || !renew_tangent(border, kkt_)) return;
  scale_kkt(border);
  turns_.follow(model_, iterate());
  if (!solver_.renew_border(kkt_, turns_.turns(model_))) factored_h_ = 0;
}

void StepSolver::solve_mass(const State& x, const VectorXd& force, const VectorXd& constraint) {
  factored_h_ = 0;
  model_.kkt(x, constraints_, {0, 0, 1}, 1, kkt_);
  factorize(0);
  right_.resize(kkt_.rows());
  right_.head(model_.n_dofs()) = force.cwiseQuotient(scales_);
  right_.tail(model_.n_constraints()) = constraint;
  solver_.solve(kkt_, right_, solution_);
}

void StepSolver::solve_accelerations(State& x) {
  x.a.setZero(model_.n_dofs());
  model_.constraints(x, constraints_);
  model_.force(x, force_);
  solve_mass(x, -force_, constraints_.acceleration);
  x.a = solution_.head(model_.n_dofs()).cwiseQuotient(scales_);
  x.lambda = solution_.tail(model_.n_constraints());
}

void StepSolver::make_consistent(State& x) {
  solve_accelerations(x);
  restart(x);
}

void StepSolver::project_velocity(State& x) {
  model_.constraints(x, constraints_);
  constraint_ = -constraints_.rate;
  for (const auto& entry : constraints_.jacobian)
    constraint_[entry.row()] -= entry.value() * x.v[entry.col()];
  force_.setZero(model_.n_dofs());
  solve_mass(x, force_, constraint_);
  x.v += solution_.head(model_.n_dofs()).cwiseQuotient(scales_);
}

/// The matrix has the pattern of the tangent; therefore its analysis serves the next step, too.
VectorXd StepSolver::balance(State& x, double frequency) {
  factored_h_ = 0;
  analysed_version_ = model_.pattern_version();
  return balance_forces(model_, x, frequency, solver_, kkt_);
}

VectorXd StepSolver::held_part(const State& x, const VectorXd& w) {
  model_.constraints(x, constraints_);
  constraint_.setZero(model_.n_constraints());
  for (const auto& entry : constraints_.jacobian)
    constraint_[entry.row()] += entry.value() * w[entry.col()];
  force_.setZero(model_.n_dofs());
  solve_mass(x, force_, constraint_);
  return solution_.head(model_.n_dofs()).cwiseQuotient(scales_);
}

void StepSolver::solve_kept(const VectorXd& force, const VectorXd& constraint, VectorXd& dq,
                            VectorXd& mu) {
  right_.resize(kkt_.rows());
  right_.head(model_.n_dofs()) = force.cwiseQuotient(scales_);
  right_.tail(model_.n_constraints()) = constraint;
  solver_.solve(kkt_, right_, solution_, false);
  dq = solution_.head(model_.n_dofs()).cwiseQuotient(scales_);
  mu = solution_.tail(model_.n_constraints());
}

bool StepSolver::stays_on_branch(const State& x, double h) {
  if (rigid_dofs_.empty()) return true;
  const VectorXd& end = iterate();
  double motion = 0, correction = 0;
  for (const int i : rigid_dofs_) {
    motion = std::max(motion, scales_[i] * std::abs(predicted_[i] - x.q[i]));
    correction = std::max(correction, scales_[i] * std::abs(end[i] - predicted_[i]));
  }
  failure_ = correction > kCorrection * std::max(motion, kPartOfSize * size_)
                 ? formatted("rigid bodies move by %.2g m more than predicted", correction)
                 : branch_.refusal(end, x.t + h, std::abs(h) <= crossing_h_);
  history_ += failure_;
  return failure_.empty();
}

TriedStep StepSolver::solve_step(State& x, double h, double allowed) {
  history_.clear();
  failure_.clear();
  set_scales();
  const int before = counts_.newton;
  try {
    if (!rigid_dofs_.empty()) branch_.begin(x);
    begin(x, h);
    if (!rigid_dofs_.empty()) predicted_ = iterate();
    if (newton(h) && stays_on_branch(x, h)) {
      TriedStep out{true, std::isfinite(allowed) ? local_error(x, allowed) : 0,
                    counts_.newton - before};
      // If the error is this small, slow contraction of a kept tangent must not keep the step
      // small.
      if (out.error < kMaxChange * allowed) out.iterations = fresh_iterations_;
      // Written so that an error that is not a number counts as too large.
      if (!(out.error <= allowed)) return out;
      if (finish_sound(x)) return out;
    }
  } catch (const Error& error) {
    if (error.kind() != Error::Kind::numerical) throw;
    history_ += error.what();
  }
  factored_h_ = 0;
  return {};
}

bool StepSolver::finish_sound(State& x) {
  constexpr double kLargeCorrection =
      1e-3;  // a tenth of an element length, with 100 elements along a body
  const bool look = largest_correction_ > kLargeCorrection;
  if (look) before_ = x;
  finish(x);
  model_.follow_turns(x);
  if (!look || model_.smallest_area_ratio(x) > 0) {
    keep();
    return true;
  }
  history_ += "converged to a state with inverted material";
  x = before_;
  return false;
}

double StepSolver::local_error(const State&, double) {
  throw Error::input(name_ + " does not estimate its local error, which adaptive steps need");
}

TriedStep StepSolver::try_step(State& x, double h, double allowed) {
  const TriedStep out = solve_step(x, h, allowed);
  if (!out.converged) {
    ++counts_.rejected;
    if (++failures_ > settings_.max_halvings) give_up(x, h, failures_);
    return out;
  }
  failures_ = 0;
  crossing_h_ = kCrossing * std::abs(h);
  ++(out.error <= allowed ? counts_.steps : counts_.inaccurate);
  return out;
}

bool StepSolver::is_kept(double h) const {
  return std::abs(factored_h_ / h - 1) <= 1e-6 && analysed_version_ == model_.pattern_version();
}

bool StepSolver::newton(double h) {
  // A kept tangent is replaced if it contracts less than this or needs more iterations.
  constexpr double kContraction = 0.2;
  constexpr int kPatience = 6;
  // Corrections below these limits, relative to the size of the model, are round-off if they no
  // longer decrease: with any tangent, or with a new one.
  constexpr double kRoundOff = 1e-14, kFreshRoundOff = 1e-12;
  double last = 0;
  bool fresh = false;
  largest_correction_ = 0;
  fresh_iterations_ = 0;
  for (int iteration = 1; iteration <= settings_.max_iterations; ++iteration) {
    residual(force_, constraint_);
    if (iteration == 1 && is_kept(h)) renew_border();
    if (!is_kept(h)) {
      factorize_here(h);
      fresh = true;
    }
    force_ *= -scale();
    constraint_ *= -1;
    solve_kept(force_, constraint_, dq_, mu_);
    const double r = right_.lpNorm<Eigen::Infinity>();
    const double correction = solution_.head(model_.n_dofs()).lpNorm<Eigen::Infinity>() / size_;
    largest_correction_ = std::max(largest_correction_, correction);
    ++counts_.newton;
    fresh_iterations_ += fresh;
    history_ += formatted("%d: |r| %.1e, |dq| %.1e; ", iteration, r, correction);
    if (!std::isfinite(r) || !std::isfinite(correction)) return false;
    mu_ /= scale();
    correct(dq_, mu_);

    const double contraction = iteration > 1 ? correction / last : 1;
    const double error =
        contraction < 1 ? correction * contraction / (1 - contraction) : correction;
    const double tolerance = settings_.tolerance * resolved() / size_;
    if (correction <= tolerance || error <= 0.01 * tolerance) return true;
    if (correction <= (fresh ? kFreshRoundOff : kRoundOff) && contraction > kContraction)
      return true;
    if (fresh && iteration > 3 && contraction > 2) return false;  // diverges with a new tangent
    if (iteration > 1 && (contraction > kContraction || iteration >= kPatience)) factored_h_ = 0;
    last = correction;
  }
  return false;
}

void StepSolver::give_up(const State& x, double h, int failures) const {
  if (!failure_.empty())
    throw Error::numerical(
        name_ +
        formatted(": no step can be made at t = %.6g s, step %d, with step size %.2e s "
                  "after %d halvings: ",
                  x.t, counts_.steps + 1, h, failures - 1) +
        failure_ + ". " + advice_);
  const std::string text = formatted(
      ": Newton's method does not converge at t = %.6g s, step %d, with step size %.2e s after %d "
      "halvings; the smallest area ratio is %.2e (iterations ",
      x.t, counts_.steps + 1, h, failures - 1, model_.smallest_area_ratio(x));
  throw Error::numerical(name_ + text + history_ + "). " + advice_ +
                         " An area ratio near zero means that the material has collapsed.");
}

void StepSolver::archive(Archive& memory) {
  const int now = model_.pattern_version();
  // The scales belong to earlier positions of the material lines, and the kept tangent to an
  // earlier step. Therefore they cannot be computed again and are saved.
  memory(counts_, scales_, size_, kkt_, factored_h_, failures_, turns_);
  memory.up_to_date(scaled_version_, now);
  if (memory.up_to_date(analysed_version_, now)) solver_.archive(memory, kkt_);
}

void StepSolver::advance(State& x, double t_end,
                         const std::function<void(const State&)>& accepted) {
  const double whole = t_end - x.t;
  double h = whole;
  int halvings = 0;
  crossing_h_ = kCrossing * whole;
  while (x.t < t_end) {
    if (x.t + h > t_end - 1e-9 * whole) h = t_end - x.t;
    if (solve_step(x, h, std::numeric_limits<double>::infinity()).converged) {
      if (std::abs(x.t - t_end) <= 1e-9 * whole) x.t = t_end;
      ++counts_.steps;
      accepted(x);
      if (halvings > 0) {
        h *= 2;
        --halvings;
      }
      continue;
    }
    ++counts_.rejected;
    if (++halvings > settings_.max_halvings) give_up(x, h, halvings);
    h *= 0.5;
  }
}

}  // namespace flexmorph::fem
