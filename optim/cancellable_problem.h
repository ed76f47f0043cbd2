#pragma once

#include <functional>
#include <utility>

#include "optim/problem.h"

namespace flexmorph::optim {

/// A problem whose evaluations fail once a computation is cancelled. An optimizer then ends after
/// few more trials, none of which is computed, and returns the best design so far.
class CancellableProblem final : public Problem {
 public:
  /// Wraps a problem, which must outlive the new object.
  /// @param keep_running  cancellation callback, called before every evaluation but the first one,
  ///                      without which an optimizer has no design to return; false cancels
  CancellableProblem(Problem& problem, std::function<bool()> keep_running)
      : problem_(problem), keep_running_(std::move(keep_running)) {}

  int n_variables() const override { return problem_.n_variables(); }
  int n_constraints() const override { return problem_.n_constraints(); }
  VectorXd lower() const override { return problem_.lower(); }
  VectorXd upper() const override { return problem_.upper(); }
  VectorXd start() const override { return problem_.start(); }
  ProblemValues evaluate(const VectorXd& x) override {
    if (started_ && !keep_running_()) throw Error::numerical("the computation is cancelled");
    started_ = true;
    return problem_.evaluate(x);
  }
  bool acceptable(const VectorXd& x) override { return problem_.acceptable(x); }
  bool has_curvature() const override { return problem_.has_curvature(); }
  MatrixXd curvature(const VectorXd& x, double sigma, const VectorXd& lambda) override {
    return problem_.curvature(x, sigma, lambda);
  }

 private:
  Problem& problem_;
  std::function<bool()> keep_running_;
  bool started_ = false;
};

}  // namespace flexmorph::optim
