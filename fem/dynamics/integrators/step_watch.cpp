#include "fem/dynamics/integrators/step_watch.h"

#include <algorithm>
#include <cmath>

#include "fem/solve/scaled_constraints.h"

namespace flexmorph::fem {

void archive(Archive& memory, Alternation& a) { memory(a.time, a.joint, a.part); }

void MultiplierWatch::archive(Archive& memory, const Model& model) {
  memory(steps_, h_, last_, before_, difference_, largest_, in_a_row_, found_);
  memory.up_to_date(version_, model.pattern_version());
}

void MultiplierWatch::begin(const Model& model, const State& x, double h) {
  const bool same_rows = largest_.size() == x.lambda.size();
  version_ = model.pattern_version();
  steps_ = 1;
  h_ = h;
  last_ = x.lambda;
  in_a_row_.assign(static_cast<size_t>(x.lambda.size()), 0);
  if (same_rows)
    largest_ = largest_.cwiseMax(x.lambda.cwiseAbs());
  else
    largest_ = x.lambda.cwiseAbs();
}

void MultiplierWatch::see(const Model& model, const State& x, double h) {
  if (x.lambda.size() == 0) return;
  if (version_ != model.pattern_version() || std::abs(h - h_) > 1e-6 * h_)
    return begin(model, x, h);
  if (++steps_ == 2) {
    before_ = last_;
    last_ = x.lambda;
    difference_.setZero(x.lambda.size());
    return;
  }
  largest_ = largest_.cwiseMax(x.lambda.cwiseAbs());
  const double least = 1e-6 * largest_.maxCoeff();  // for rows with hardly any force
  for (Eigen::Index i = 0; i < x.lambda.size(); ++i) {
    const double second = x.lambda[i] - 2 * last_[i] + before_[i];
    const double part = 0.25 * std::abs(second) / std::max(largest_[i], least);
    int& in_a_row = in_a_row_[static_cast<size_t>(i)];
    in_a_row = second * difference_[i] < 0 && part > kNoticed ? in_a_row + 1 : 0;
    difference_[i] = second;
    if (in_a_row < kSteps) continue;
    const std::string& joint =
        model.joints()[static_cast<size_t>(joint_of_row(model, static_cast<int>(i)))]->name();
    if (!found_) found_ = {x.t - kSteps * h, joint, part};
    if (part > found_->part) found_ = {found_->time, joint, part};
  }
  std::swap(before_, last_);
  last_ = x.lambda;
}

}  // namespace flexmorph::fem
