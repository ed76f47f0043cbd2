#include "optim/search.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "geometry/cpu_time.h"
#include "optim/kkt.h"

namespace flexmorph::optim {
namespace {

constexpr int kStagnatingRows = 3;

bool finite(const ProblemValues& r) {
  return std::isfinite(r.f) && r.df.allFinite() && r.g.allFinite() && r.dg.allFinite();
}

std::string what_is_not_finite(const ProblemValues& r) {
  if (!std::isfinite(r.f)) return "the objective is not finite";
  if (!r.df.allFinite()) return "the gradient of the objective is not finite";
  if (!r.g.allFinite()) return "a constraint is not finite";
  return "the gradient of a constraint is not finite";
}

}  // namespace

double violation(const ProblemValues& response) {
  return response.g.size() == 0 ? 0 : std::max(0.0, response.g.maxCoeff());
}

double attained_objective(const ProblemValues& r) {
  return r.n_bounds == 0 ? r.f : r.f + r.g.segment(r.first_bound, r.n_bounds).maxCoeff();
}

double design_violation(const ProblemValues& r) {
  double out = 0;
  for (Eigen::Index i = 0; i < r.g.size(); ++i)
    if (i < r.first_bound || i >= r.first_bound + r.n_bounds) out = std::max(out, r.g[i]);
  return out;
}

std::string scientific(double value) {
  std::array<char, 32> text;
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value,
                                 std::chars_format::scientific, 1);
  return {text.data(), end.ptr};
}

Search::Search(Problem& problem, const Settings& settings, const Observer& observe)
    : problem_(problem),
      settings_(settings),
      observe_(observe),
      m_(problem.n_constraints()),
      lower_(problem.lower()),
      upper_(problem.upper()) {
  const int n = problem.n_variables();
  if (n <= 0) throw Error::input("optimizer: the problem has no variables");
  if (lower_.size() != n || upper_.size() != n) {
    throw Error::input("optimizer: the bounds need one entry for each of the " + std::to_string(n) +
                       " variables");
  }
  for (int j = 0; j < n; ++j) {
    if (!std::isfinite(lower_[j]) || !std::isfinite(upper_[j]) || lower_[j] > upper_[j]) {
      throw Error::input(
          "optimizer: bounds of variable " + std::to_string(j) + " are " +
          std::to_string(lower_[j]) + " and " + std::to_string(upper_[j]) +
          "; they must be finite, and the lower one must not be above the upper one");
    }
  }
  mark_ = cpu_seconds();
}

Point Search::start() {
  Point point{problem_.start(), {}};
  if (point.x.size() != n())
    throw Error::input("optimizer: the start has a wrong number of variables");
  for (int j = 0; j < n(); ++j) {
    if (!(point.x[j] >= lower_[j] && point.x[j] <= upper_[j])) {
      throw Error::input("optimizer: variable " + std::to_string(j) + " starts at " +
                         std::to_string(point.x[j]) + ", outside its bounds " +
                         std::to_string(lower_[j]) + " to " + std::to_string(upper_[j]));
    }
  }
  if (evaluate(point.x, point.response) == Trial::failed) {
    throw Error::numerical("optimizer: the start cannot be evaluated: " + refusal_);
  }
  return point;
}

Trial Search::evaluate(const VectorXd& x, ProblemValues& out) {
  const double begin = cpu_seconds();
  ++evaluations_;
  last_x_ = x;
  Trial trial = Trial::taken;
  bool acceptable = false;
  try {
    out = problem_.evaluate(x);
    check(out);
    if (!finite(out)) {
      trial = Trial::failed;
      refusal_ = what_is_not_finite(out);
    } else {
      acceptable = problem_.acceptable(x);
    }
  } catch (const Error& error) {
    if (error.kind() != Error::Kind::numerical) throw;
    trial = Trial::failed;
    refusal_ = error.what();
  }
  if (trial == Trial::taken && !acceptable && best_.acceptable) {
    trial = Trial::unacceptable;
    refusal_ = "the design does not meet the conditions of the problem";
  }
  if (trial == Trial::taken && better(out, acceptable)) {
    best_ = {{x, out}, acceptable};
    best_is_new_ = true;
  }
  refused_in_a_row_ = trial == Trial::taken ? 0 : refused_in_a_row_ + 1;
  inside_problem_ += cpu_seconds() - begin;
  return trial;
}

void Search::check(const ProblemValues& r) const {
  if (r.df.size() != n() || r.g.size() != m_ || r.dg.rows() != m_ ||
      (m_ > 0 && r.dg.cols() != n())) {
    throw Error::input("optimizer: the response does not belong to " + std::to_string(n()) +
                       " variables and " + std::to_string(m_) + " constraints");
  }
}

bool Search::feasible(const ProblemValues& response) const {
  return violation(response) <= settings_.feasibility;
}

bool Search::usable(const ProblemValues& response) const {
  return design_violation(response) <= settings_.feasibility;
}

bool Search::better(const ProblemValues& r, bool acceptable) const {
  if (best_.point.x.size() == 0) return true;
  if (acceptable != best_.acceptable) return acceptable;
  const ProblemValues& b = best_.point.response;
  if (usable(r) != usable(b)) return usable(r);
  return usable(r) ? attained_objective(r) < attained_objective(b)
                   : design_violation(r) < design_violation(b);
}

bool Search::row(int iteration, const Point& point) {
  rows_ = iteration;
  const KktPoint kkt = kkt_point(point.response, point.x, lower_, upper_, kActiveTolerance);
  Iterate it;
  it.iteration = iteration;
  it.evaluations = evaluations_;
  it.x = &point.x;
  it.response = &point.response;
  it.kkt = kkt.residual;
  it.violation = violation(point.response);
  it.change = previous_row_.size() == 0 ? 0 : (point.x - previous_row_).lpNorm<Eigen::Infinity>();
  it.improved = best_is_new_ && usable(point.response) && point.x == best_.point.x;
  if (it.improved) best_is_new_ = false;
  const double now = cpu_seconds();
  it.seconds = std::max(0.0, now - mark_ - inside_problem_);
  const bool keep_running = !observe_ || observe_(it);
  mark_ = cpu_seconds();
  inside_problem_ = 0;

  previous_row_ = point.x;
  objectives_.push_back(point.response.f);
  if (objectives_.size() > static_cast<size_t>(settings_.rest.rows) + 1) objectives_.pop_front();
  if (usable(point.response)) last_usable_row_ = rows_;
  const bool found = best_.point.x.size() > 0 && usable(best_.point.response);
  best_objectives_.push_back(found ? attained_objective(best_.point.response)
                                   : std::numeric_limits<double>::infinity());
  if (best_objectives_.size() > Verdict::kPlateauRows + 1) best_objectives_.pop_front();
  if (keep_running)
    end_or_continue(it, point, kkt.lambda.sum());
  else
    stop(Stop::observer, "the calling program ended the optimization");
  stop_when_spent();
  return !stopped_;
}

/// Stops the search if the present row meets one of the criteria to stop.
/// @param price  sum of the multipliers at this row
void Search::end_or_continue(const Iterate& it, const Point& point, double price) {
  const StoppingWindow& rest = settings_.rest;
  const bool met = it.violation <= settings_.feasibility;
  const std::string residual = "; KKT residual " + scientific(it.kkt);
  const double change = recent_change();
  if (it.kkt <= settings_.kkt_tolerance && met) {
    stop(Stop::converged, "KKT residual " + scientific(it.kkt) + " and violation " +
                              scientific(it.violation) + " are below their tolerances");
    // An earlier design may have a lower objective, because it uses the tolerances or differs by
    // less than the criterion of stagnation. It is not a minimum; therefore the last design is
    // preferred.
    keep_last(point, std::max(rest.objective,
                              settings_.kkt_tolerance + settings_.feasibility * (1 + 2 * price)));
  } else if (change <= rest.objective && it.kkt <= rest.kkt && met) {
    stop(Stop::converged, "the objective changed by " + scientific(change) + " over " +
                              std::to_string(rest.rows) + " iterations" + residual);
    if (std::isfinite(rest.kkt)) keep_last(point, rest.objective);
  } else if (settings_.plateau && at_plateau()) {
    stop(Stop::plateau, plateau_text() + residual);
  } else if (rows_ > 1 && stagnates(it.change, it.violation)) {
    stop(Stop::converged, "in three iterations in a row no variable changed by more than " +
                              scientific(settings_.change_tolerance) + residual);
  } else if (it.iteration >= settings_.max_iterations) {
    std::string why = "the limit of " + std::to_string(settings_.max_iterations) +
                      " iterations is reached" + residual;
    if (std::isfinite(change))
      why += "; the objective changed by " + scientific(change) + " over the last " +
             std::to_string(rest.rows) + " iterations";
    stop(Stop::iteration_limit, why);
  }
}

/// Returns the difference of the largest and the smallest objective of the last rows; infinite if
/// there are too few rows.
double Search::recent_change() const {
  const auto rows = static_cast<size_t>(settings_.rest.rows);
  if (rows == 0 || objectives_.size() <= rows) return std::numeric_limits<double>::infinity();
  const auto [least, largest] = std::minmax_element(objectives_.begin(), objectives_.end());
  return *largest - *least;
}

/// Makes the last row the best design if the best one is better by no more than `slack`.
void Search::keep_last(const Point& point, double slack) {
  if (attained_objective(point.response) <= attained_objective(best_.point.response) + slack)
    best_.point = point;
}

bool Search::spent() const {
  return settings_.max_evaluations > 0 && evaluations_ >= settings_.max_evaluations;
}

void Search::stop_when_spent() {
  if (!spent()) return;
  stop(Stop::evaluation_limit,
       "the limit of " + std::to_string(settings_.max_evaluations) + " state solves is reached");
}

bool Search::stagnates(double change, double violation) {
  const bool resting = change < settings_.change_tolerance && violation <= settings_.feasibility;
  resting_ = resting ? resting_ + 1 : 0;
  return resting_ >= kStagnatingRows;
}

void Search::stop(Stop stop, const std::string& message) {
  if (stopped_) return;  // the first reason counts
  stopped_ = true;
  stop_ = stop;
  message_ = message;
}

/// Returns the decrease of the objective of the best usable design over the last rows; NaN if there
/// were fewer rows, or no usable design before them.
double Search::improvement_over(int rows) const {
  const auto n = static_cast<size_t>(rows);
  if (best_objectives_.size() <= n) return std::numeric_limits<double>::quiet_NaN();
  const double before = best_objectives_[best_objectives_.size() - 1 - n];
  return std::isfinite(before) ? before - best_objectives_.back()
                               : std::numeric_limits<double>::quiet_NaN();
}

bool Search::at_plateau() const {
  constexpr int kLateIterates = 10;  // no plateau if the last 10 iterates are infeasible
  return rows_ - last_usable_row_ < kLateIterates &&
         improvement_over(Verdict::kPlateauRows) < Verdict::kPlateau;  // false for NaN
}

Verdict Search::verdict_on(const Result& result) const {
  Verdict out;
  out.kkt = result.kkt;
  out.improvement = improvement_over(Verdict::kImprovementRows);
  if (result.violation > settings_.feasibility) return out;
  if (result.kkt <= settings_.kkt_tolerance)
    out.kind = Verdict::Kind::converged;
  else if (at_plateau())
    out.kind = Verdict::Kind::stagnated;
  return out;
}

Result Search::result() {
  if (last_x_ != best_.point.x) {
    const Point kept = best_.point;
    ProblemValues again;
    // If the evaluation fails now although it succeeded before, the earlier response stays.
    if (evaluate(kept.x, again) == Trial::taken) best_.point = {kept.x, again};
  }
  Result result;
  result.x = best_.point.x;
  result.response = best_.point.response;
  result.kkt = kkt_point(result.response, result.x, lower_, upper_, kActiveTolerance).residual;
  result.violation = design_violation(result.response);
  result.iterations = rows_;
  result.evaluations = evaluations_;
  result.stop = stop_;
  result.message = message_;
  result.verdict = verdict_on(result);
  return result;
}

}  // namespace flexmorph::optim
