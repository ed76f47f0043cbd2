// Shows that the second derivatives of design problems of static plates are correct: the sum and
// the worst of two loads, as objective and as limit, against differences of gradients and by the
// third order of the Taylor remainder.

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>

#include "optim/mmc/loads/compliance_evaluator.h"
#include "optim/mmc/problem/mmc_problem.h"
#include "tests/optim/mmc_small.h"
#include "tests/support/rates.h"

namespace flexmorph::mmc::test {
namespace {

struct Choice {
  const char* name;
  Goal goal;
};
void PrintTo(const Choice& choice, std::ostream* out) { *out << choice.name; }

std::vector<Choice> choices() {
  Goal inertia = least_compliance();
  inertia.limits.emplace_back(*find_response("inertia", ""), 1e-3, false, kPlate);
  return {{"sum", least_compliance()},
          {"worst", least_compliance(0.5, kComplianceWorst)},
          {"inertia", inertia},
          {"volume", least_volume(10)},
          {"volume_worst", least_volume(10, kComplianceWorst)}};
}

/// Returns two loads at the right end of a plate that is clamped at its left end.
std::unique_ptr<ComplianceEvaluator> loads() {
  std::vector<fem::HeldUnknown> held;
  for (int j = 0; j <= kGrid.ny; ++j)
    for (const int c : {0, 1}) held.push_back({kGrid.node(0, j), c});
  const std::vector<LoadCase> cases = {
      {"down", 1, {{kGrid.node(kGrid.nx, kGrid.ny / 2), {0, -1e3}}}},
      {"along", 0.3, {{kGrid.node(kGrid.nx, 0), {4e3, 1e2}}}}};
  return std::make_unique<ComplianceEvaluator>(Plate{kGrid, kSection, {}}, held, cases, false);
}

class EveryGoal : public ::testing::TestWithParam<Choice> {
 protected:
  const Design design{kGrid, random_layout(3), kScale};
  const Ersatz ersatz{kGrid, tdf_settings().alpha, strip(), {}};
  const std::unique_ptr<ComplianceEvaluator> response = loads();
  MmcProblem problem{{kPlate, design, ersatz, *response}, tdf_settings(2), GetParam().goal};
  const double sigma = 0.7;
  const VectorXd lambda = VectorXd::LinSpaced(problem.n_constraints(), 0.4, 1.3);

  VectorXd gradient(const VectorXd& x) {
    const optim::ProblemValues r = problem.evaluate(x);
    return sigma * r.df + r.dg.transpose() * lambda;
  }
};
INSTANTIATE_TEST_SUITE_P(Table, EveryGoal, ::testing::ValuesIn(choices()),
                         [](const auto& test) { return std::string(test.param.name); });

// Differences of order four are used, because no step is suitable for order two: with 1e-4 cells
// the error is 1e-6 to 5e-6 (9 times as much with 3e-4), and with 1e-5 cells round-off is as large
// (1e-11 of the gradient divided by the step). The steps h = 1.5e-4 and 3e-4 are combined to order
// four.
TEST_P(EveryGoal, MeetsDifferencesOfGradients) {
  const VectorXd x = problem.start(), cells = cells_of(design);
  const MatrixXd hessian = problem.curvature(x, sigma, lambda);
  ASSERT_EQ(hessian.rows(), x.size());
  EXPECT_LT((hessian - hessian.transpose()).cwiseAbs().maxCoeff(),
            1e-12 * hessian.cwiseAbs().maxCoeff());
  for (unsigned seed = 1; seed <= 5; ++seed) {
    VectorXd d = VectorXd::Random(x.size());
    d.head(cells.size()) = d.head(cells.size()).cwiseProduct(cells);
    const auto difference = [&](double h) {
      return VectorXd((gradient(x + h * d) - gradient(x - h * d)) / (2 * h));
    };
    const VectorXd differences = (4 * difference(1.5e-4) - difference(3e-4)) / 3;
    EXPECT_LT((hessian * d - differences).cwiseAbs().maxCoeff(),
              1e-6 * differences.cwiseAbs().maxCoeff())
        << seed;
  }
}

// f(x + h d) - f - h g·d - h²/2 d·H d decreases with h³. The order is that of the root mean square
// over directions, because the third derivative may nearly vanish along a single one. h is in
// cells: at 1e-2 the terms of order h⁴ are smaller than those of h³ by a few hundredths of the
// band's width; at 1e-3 the terms of h³ are 1e-9/6 of f, and round-off is 1e-13 of f.
TEST_P(EveryGoal, LeavesARemainderOfOrderThree) {
  constexpr int kDirections = 16;
  const VectorXd x = problem.start(), cells = cells_of(design);
  const auto value = [&](const VectorXd& at) {
    const optim::ProblemValues r = problem.evaluate(at);
    return sigma * r.f + lambda.dot(r.g);
  };
  const double f = value(x);
  const VectorXd g = gradient(x);
  const MatrixXd hessian = problem.curvature(x, sigma, lambda);
  std::mt19937 engine(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<VectorXd> directions(kDirections, x);
  for (VectorXd& d : directions) {
    for (double& each : d) each = uniform(engine);
    d.head(cells.size()) = d.head(cells.size()).cwiseProduct(cells);
  }
  const testing::Rate rate =
      testing::fit_rate({1e-2, 6e-3, 4e-3, 2.5e-3, 1.6e-3, 1e-3}, [&](double h) {
        double squares = 0;
        for (const VectorXd& d : directions)
          squares +=
              std::pow(value(x + h * d) - f - h * g.dot(d) - 0.5 * h * h * d.dot(hessian * d), 2);
        return std::sqrt(squares / kDirections);
      });
  EXPECT_NEAR(rate.order(), 3.0, 0.1) << rate.table();
}

}  // namespace
}  // namespace flexmorph::mmc::test
