#pragma once

// Small problems with known optima, for all optimizers. Gradients are written out, and checked
// against differences by a test of their own.

#include <functional>
#include <string>
#include <vector>

#include "optim/problem.h"

namespace flexmorph::optim::test {

/// A problem put together from one function. Counts its evaluations.
class Analytic : public Problem {
 public:
  using Function = std::function<void(const VectorXd& x, Response& r)>;

  Analytic(std::string name, VectorXd lower, VectorXd upper, VectorXd start, int n_constraints,
           Function function, double optimum)
      : name(std::move(name)),
        optimum(optimum),
        lower_(std::move(lower)),
        upper_(std::move(upper)),
        start_(std::move(start)),
        n_constraints_(n_constraints),
        function_(std::move(function)) {}

  int n_variables() const override { return static_cast<int>(lower_.size()); }
  int n_constraints() const override { return n_constraints_; }
  VectorXd lower() const override { return lower_; }
  VectorXd upper() const override { return upper_; }
  VectorXd start() const override { return start_; }

  Response evaluate(const VectorXd& x) override {
    ++evaluations;
    last_x = x;
    Response r;
    r.df = VectorXd::Zero(n_variables());
    r.g = VectorXd::Zero(n_constraints_);
    r.dg = MatrixXd::Zero(n_constraints_, n_variables());
    function_(x, r);
    return r;
  }

  std::string name;
  double optimum;
  VectorXd solution;  ///< where it is known
  int evaluations = 0;
  VectorXd last_x;

 private:
  VectorXd lower_, upper_, start_;
  int n_constraints_;
  Function function_;
};

Analytic cantilever();     ///< Svanberg (1987), example 1: five boxes
Analytic two_bar_truss();  ///< Svanberg (1987), example 2
Analytic hock_schittkowski_35();
Analytic hock_schittkowski_43();
Analytic hock_schittkowski_76();
Analytic hock_schittkowski_100();
/// min Σ c_j / x_j, Σ a_j x_j <= half of Σ a_j: sizes of a thousand bars.
Analytic many_bars(int n);

std::vector<Analytic> all_problems();

}  // namespace flexmorph::optim::test
