#include "optim/mmc/problem/shared_problem.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "optim/mmc/problem/motion_response.h"

namespace flexmorph::mmc {

size_t shared_limit(const Goal& goal) {
  const auto counts = [](const Limit& limit) { return limit.volume && !limit.at_least; };
  const auto found = std::find_if(goal.limits.begin(), goal.limits.end(), counts);
  if (std::count_if(goal.limits.begin(), goal.limits.end(), counts) != 1)
    throw Error::input(
        "shared mass: every body that shares the mass must have exactly one limit of volume or "
        "mass");
  return static_cast<size_t>(found - goal.limits.begin());
}

SharedProblem::SharedProblem(std::vector<Part> parts) : parts_(std::move(parts)), first_{0} {
  if (parts_.empty()) throw Error::input("shared mass: there are no bodies that share it");
  shares_.resize(static_cast<Eigen::Index>(parts_.size()));
  for (size_t b = 0; b < parts_.size(); ++b) {
    const MmcProblem& part = *parts_[b].problem;
    const Goal& goal = part.goal();
    of_motion_ = goal.objective->of_motion;
    if (!of_motion_ && (goal.objective->per_load || !goal.objective->needs_state()))
      throw Error::input(
          "shared mass: the objective of every body must be the sum of its compliances");
    first_.push_back(first_.back() + part.n_variables());
    n_constraints_ += part.n_constraints();
    shares_[static_cast<Eigen::Index>(b)] = 0;
    budget_.push_back(-1);
    if (!parts_[b].shares) continue;
    if (!(parts_[b].full_mass > 0) || !std::isfinite(parts_[b].full_mass))
      throw Error::input("shared mass: the mass of full body " + std::to_string(b + 1) + " is " +
                         std::to_string(parts_[b].full_mass) + " kg; it must be positive");
    const size_t limit = shared_limit(goal);
    shares_[static_cast<Eigen::Index>(b)] = parts_[b].full_mass * *goal.limits[limit].volume;
    budget_.back() = part.row_of(limit);
    --n_constraints_;
  }
  if (shares_.sum() == 0) return;
  shares_ /= shares_.sum();
  ++n_constraints_;
}

template <class Of>
VectorXd SharedProblem::joined(Of&& of) const {
  VectorXd out(n_variables());
  for (size_t b = 0; b < parts_.size(); ++b)
    out.segment(first_[b], first_[b + 1] - first_[b]) = of(*parts_[b].problem);
  return out;
}

VectorXd SharedProblem::lower() const {
  return joined([](const MmcProblem& p) { return p.lower(); });
}
VectorXd SharedProblem::upper() const {
  return joined([](const MmcProblem& p) { return p.upper(); });
}
VectorXd SharedProblem::start() const {
  return joined([](const MmcProblem& p) { return p.start(); });
}

int SharedProblem::row_of(size_t body, int own) const {
  if (own == budget_[body]) return 0;
  int row = shares_.sum() > 0 ? 1 : 0;
  for (size_t b = 0; b < body; ++b)
    row += parts_[b].problem->n_constraints() - (budget_[b] >= 0 ? 1 : 0);
  return row + own - (budget_[body] >= 0 && own > budget_[body] ? 1 : 0);
}

/// Adds the gradients of limited responses of the motion by the designs of all other bodies.
void SharedProblem::add_gradients_of_others(optim::ProblemValues& out) {
  for (size_t b = 0; b < parts_.size(); ++b) {
    const MmcProblem& part = *parts_[b].problem;
    const std::vector<Limit>& limits = part.goal().limits;
    for (size_t k = 0; k < limits.size(); ++k) {
      const ResponseRow& row = *limits[k].row;
      if (!row.of_motion) continue;
      const double f = (*part.values(row))[0];
      for (size_t c = 0; c < parts_.size(); ++c) {
        if (c == b) continue;
        const CellScaleFactors& by = part.motion()->state->limit_gradient(row, b, c);
        out.dg.row(row_of(b, part.row_of(k))).segment(first_[c], first_[c + 1] - first_[c]) =
            parts_[c].problem->pull_back_scale_factors(by) / f;
      }
    }
  }
}

optim::ProblemValues SharedProblem::evaluate(const VectorXd& x) {
  optim::ProblemValues out;
  out.df.resize(n_variables());
  out.g.setZero(n_constraints());
  out.dg.setZero(n_constraints(), n_variables());
  double sum = 0;
  if (of_motion_)  // the motion is computed once, when the designs of all bodies are set
    for (size_t b = 0; b < parts_.size(); ++b) parts_[b].problem->look(part_of(x, b));
  for (size_t b = 0; b < parts_.size(); ++b) {
    MmcProblem& part = *parts_[b].problem;
    const optim::ProblemValues own = part.evaluate(part_of(x, b));
    const int first = first_[b], n = first_[b + 1] - first;
    const double share = shares_[static_cast<Eigen::Index>(b)];
    if (of_motion_) {
      out.f = own.f;
      out.df.segment(first, n) = own.df;
    } else {
      const double f = (*part.values(*part.goal().objective))[0];
      sum += f;
      out.df.segment(first, n) = f * own.df;
    }
    for (int k = 0; k < part.n_constraints(); ++k) {
      const int row = row_of(b, k);
      const double weight = k == budget_[b] ? share : 1;
      out.g[row] += weight * own.g[k];
      out.dg.row(row).segment(first, n) = weight * own.dg.row(k);
    }
  }
  if (of_motion_) {
    add_gradients_of_others(out);
    return out;
  }
  out.f = std::log(sum);
  out.df /= sum;
  return out;
}

bool SharedProblem::acceptable(const VectorXd& x) {
  for (size_t b = 0; b < parts_.size(); ++b)
    if (!parts_[b].problem->acceptable(part_of(x, b))) return false;
  return true;
}

}  // namespace flexmorph::mmc
