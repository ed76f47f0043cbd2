#include "optim/mmc/problem/motion_response.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace flexmorph::mmc {

std::vector<MotionRow> motion_objectives(std::span<const Goal* const> goals) {
  std::vector<MotionRow> out;
  const auto add = [&](const MotionRow& row) {
    const auto same = [&](const MotionRow& other) { return row.same_as(other); };
    if (std::none_of(out.begin(), out.end(), same)) out.push_back(row);
  };
  for (size_t b = 0; b < goals.size(); ++b) {
    add({goals[b]->objective, b});
    for (const Addend& addend : goals[b]->addends) add({addend.row, b, addend.weight});
  }
  return out;
}

MotionState::MotionState(MotionResponse& motion, std::span<const Goal* const> goals)
    : motion_(motion), rows_(motion_objectives(goals)), factors_(goals.size()) {
  n_objectives_ = rows_.size();
  for (size_t b = 0; b < goals.size(); ++b) {
    objective_of_.push_back(goals[b]->objective);
    for (const Limit& limit : goals[b]->limits)
      if (limit.row->of_motion) rows_.push_back({limit.row, b});
  }
}

void MotionState::notify(size_t body, const CellScaleFactors& factors) {
  CellScaleFactors& known = factors_[body];
  if (known.stiffness.size() == factors.stiffness.size() && known.stiffness == factors.stiffness &&
      known.mass == factors.mass)
    return;
  known = factors;
  values_.clear();
}

MotionState::Range MotionState::rows_behind(const ResponseRow& row, size_t body) const {
  if (objective_of_[body] == &row) return {0, n_objectives_};
  size_t k = n_objectives_;
  while (k < rows_.size() && !rows_[k].same_as({&row, body})) ++k;
  return {k, std::min(k + 1, rows_.size())};
}

void MotionState::move() {
  if (values_.empty()) values_ = motion_.evaluate(rows_, factors_);
}

void MotionState::value(const ResponseRow& row, size_t body, Values& out) {
  move();
  const Range range = rows_behind(row, body);
  double sum = 0;
  out.d_stiffness.setZero(1, factors_[body].stiffness.size());
  out.d_mass.setZero(1, factors_[body].mass.size());
  for (size_t k = range.first; k < range.last; ++k) {
    sum += rows_[k].weight * values_[k].f;
    out.d_stiffness.row(0) += rows_[k].weight * values_[k].slopes[body].stiffness;
    out.d_mass.row(0) += rows_[k].weight * values_[k].slopes[body].mass;
  }
  if (!(sum > 0) || !std::isfinite(sum))
    throw Error::numerical("design problem: the " + std::string(row.words) + " is " +
                           std::to_string(sum) + "; it must be positive");
  out.f = VectorXd::Constant(1, sum);
}

const CellScaleFactors& MotionState::limit_gradient(const ResponseRow& row, size_t body,
                                                    size_t by) {
  move();
  return values_[rows_behind(row, body).first].slopes[by];
}

}  // namespace flexmorph::mmc
