#include "optim/mmc/motion_response.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace flexmorph::mmc {

MotionState::MotionState(MotionResponse& motion, const std::vector<MotionRow>& objectives,
                         const std::vector<MotionRow>& limits)
    : motion_(motion), factors_(objectives.size()) {
  const auto add = [&](const MotionRow& row) {
    const auto same = [&](const MotionRow& other) { return row.same_as(other); };
    if (std::none_of(rows_.begin(), rows_.end(), same)) rows_.push_back(row);
  };
  for (const MotionRow& row : objectives) {
    add(row);
    objective_of_.push_back(row.row);
  }
  n_objectives_ = rows_.size();
  for (const MotionRow& row : limits) rows_.push_back(row);
}

void MotionState::announce(size_t body, const CellFactors& factors) {
  CellFactors& known = factors_[body];
  if (known.stiffness.size() == factors.stiffness.size() && known.stiffness == factors.stiffness &&
      known.mass == factors.mass)
    return;
  known = factors;
  values_.clear();
}

void MotionState::value(const ResponseRow& row, size_t body, Values& out) {
  if (values_.empty()) values_ = motion_.evaluate(rows_, factors_);
  size_t first = n_objectives_, last = rows_.size();
  if (objective_of_[body] == &row) {
    first = 0;
    last = n_objectives_;
  } else {
    while (first < last && !rows_[first].same_as({&row, body})) ++first;
    last = std::min(last, first + 1);
  }
  double sum = 0;
  out.d_stiffness.setZero(1, factors_[body].stiffness.size());
  out.d_mass.setZero(1, factors_[body].mass.size());
  for (size_t k = first; k < last; ++k) {
    sum += values_[k].f;
    out.d_stiffness.row(0) += values_[k].slopes[body].stiffness;
    out.d_mass.row(0) += values_[k].slopes[body].mass;
  }
  if (!(sum > 0) || !std::isfinite(sum))
    throw Error::numerical("design problem: the " + std::string(row.words) + " of the motion is " +
                           std::to_string(sum));
  out.f = VectorXd::Constant(1, sum);
}

}  // namespace flexmorph::mmc
