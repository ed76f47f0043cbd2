#pragma once

// Small problems with known optima, for all optimizers. Gradients are written out, and checked
// against differences by a test of their own.

#include <functional>
#include <string>
#include <vector>

#include "optim/optimizer.h"
#include "optim/problem.h"
#include "tests/support/disturbance.h"

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
  /// Where no disturbance has been: there, remainders of linear functions vanish.
  const VectorXd& published_start() const { return start_; }
  VectorXd start() const override {
    VectorXd x = testing::disturbed(start_);
    if (x.size() != lower_.size() || x.size() != upper_.size()) return x;
    for (Eigen::Index i = 0; i < x.size(); ++i)  // a disturbance leaves no bounds
      if (x[i] < lower_[i] || x[i] > upper_[i]) x[i] = start_[i];
    return x;
  }

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
Analytic two_bar_truss();  ///< Svanberg (1987), the example of size and shape
/// Svanberg (1987), the pyramid of eight bars; x in cm², f in kg.
Analytic eight_bar_truss();
Analytic hock_schittkowski_35();
Analytic hock_schittkowski_43();
Analytic hock_schittkowski_76();
Analytic hock_schittkowski_100();
std::vector<Analytic> hock_schittkowski_problems();  ///< these four and 18 others
/// min Σ c_j / x_j, Σ a_j x_j <= half of Σ a_j: sizes of a thousand bars.
Analytic many_bars(int n);

std::vector<Analytic> published_problems();  ///< Svanberg's and Hock & Schittkowski's
std::vector<Analytic> all_problems();        ///< seven of all kinds, for tests of anything else

/// What an optimizer needs on problems of a few variables whose optima lie several units from the
/// start. The defaults are for structures, where a step must stay small.
Settings for_small_problems(const std::string& optimizer);

}  // namespace flexmorph::optim::test
