#pragma once

// Small problems with known optima, for all optimizers. The gradients are written out and compared
// with differences by a separate test.

#include <functional>
#include <string>
#include <vector>

#include "optim/optimizer.h"
#include "optim/problem.h"
#include "tests/support/disturbance.h"

namespace flexmorph::optim::test {

/// Returns a vector of these values.
VectorXd vec(std::initializer_list<double> values);

/// A problem defined by one function, which counts its evaluations.
class Analytic : public Problem {
 public:
  using Function = std::function<void(const VectorXd& x, ProblemValues& r)>;

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
  /// Returns the start without disturbance, where remainders of linear functions vanish.
  const VectorXd& published_start() const { return start_; }
  VectorXd start() const override {
    VectorXd x = testing::disturbed(start_);
    if (x.size() != lower_.size() || x.size() != upper_.size()) return x;
    for (Eigen::Index i = 0; i < x.size(); ++i)  // a disturbed start stays within its bounds
      if (x[i] < lower_[i] || x[i] > upper_[i]) x[i] = start_[i];
    return x;
  }

  ProblemValues evaluate(const VectorXd& x) override {
    ++evaluations;
    last_x = x;
    ProblemValues r;
    r.df = VectorXd::Zero(n_variables());
    r.g = VectorXd::Zero(n_constraints_);
    r.dg = MatrixXd::Zero(n_constraints_, n_variables());
    function_(x, r);
    return r;
  }

  std::string name;
  double optimum;
  VectorXd solution;  ///< The optimum, if it is known.
  int evaluations = 0;
  VectorXd last_x;

 private:
  VectorXd lower_, upper_, start_;
  int n_constraints_;
  Function function_;
};

Analytic cantilever();     ///< Svanberg (1987), example 1: five boxes.
Analytic two_bar_truss();  ///< Svanberg (1987), the example of size and shape.
/// Svanberg (1987), the pyramid of eight bars; x in cm², f in kg.
Analytic eight_bar_truss();
Analytic hock_schittkowski_35();
Analytic hock_schittkowski_43();
Analytic hock_schittkowski_76();
Analytic hock_schittkowski_100();
std::vector<Analytic> hock_schittkowski_problems();  ///< The four problems above and 18 others.
/// Returns the problem min Σ c_j / x_j, Σ a_j x_j <= half of Σ a_j: the sizes of n bars.
Analytic many_bars(int n);

std::vector<Analytic> published_problems();  ///< Problems of Svanberg and of Hock & Schittkowski.
std::vector<Analytic> all_problems();        ///< Seven problems of all kinds for the other tests.

/// Returns settings for problems of a few variables whose optima lie several units from the start.
/// The default settings are for structures, where steps must be small.
Settings for_small_problems(const std::string& optimizer);

}  // namespace flexmorph::optim::test
