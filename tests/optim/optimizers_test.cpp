// Shows that every optimizer of the table finds the published optima of small problems, by its own
// criterion and by the KKT residual of this program, and that a repeated run takes the identical
// path.

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "optim/optimizer.h"
#include "tests/optim/problems.h"
#include "tests/support/gradient_check.h"

namespace flexmorph::optim::test {
namespace {

class EveryOptimizer : public ::testing::TestWithParam<std::string> {};

TEST_P(EveryOptimizer, FindsTheKnownOptimum) {
  const Settings settings = for_small_problems(GetParam());
  // Near the optimum the error of f is the multipliers times the feasibility (1e-7) plus the KKT
  // residual times the distance: at most 1e-5 of f, tested with 1e-4; 1e-6 where the KKT residual
  // is 1e-8.
  const double tolerance = GetParam() == "ipopt" ? 1e-6 : 1e-4;
  for (Analytic& problem : all_problems()) {
    SCOPED_TRACE(problem.name);
    const Result result = make_optimizer(settings)->minimize(problem, {});
    EXPECT_NEAR(result.response.f, problem.optimum, tolerance * std::abs(problem.optimum))
        << to_string(result.stop) << ": " << result.message;
    EXPECT_LE(result.violation, settings.feasibility);
    EXPECT_TRUE((result.x.array() >= problem.lower().array()).all());
    EXPECT_TRUE((result.x.array() <= problem.upper().array()).all());
    EXPECT_EQ(result.evaluations, problem.evaluations);
    EXPECT_EQ(problem.last_x, result.x);  // the problem is left at the result
    if (result.stop == Stop::converged) {
      EXPECT_LE(result.kkt, 100 * settings.kkt_tolerance);
    }
  }
}

// With the defaults for structures (small steps from the first one on), the problems start about
// one unit from the optimum. HS76 ends at a bound.
TEST_P(EveryOptimizer, FindsTheOptimumWithItsDefaults) {
  for (Analytic problem : {cantilever(), hock_schittkowski_76(), many_bars(1000)}) {
    SCOPED_TRACE(problem.name);
    Settings settings;
    settings.name = GetParam();
    settings.max_iterations = 600;
    int rows = 0;
    double largest_change = 0;
    const Result result = make_optimizer(settings)->minimize(problem, [&](const Iterate& it) {
      ++rows;
      EXPECT_EQ(it.iteration, rows);
      EXPECT_GE(it.seconds, 0);
      EXPECT_TRUE(std::isfinite(it.kkt));
      EXPECT_EQ(it.violation, std::max(0.0, it.response->g.maxCoeff()));
      largest_change = std::max(largest_change, it.change);
      return true;
    });
    EXPECT_NEAR(result.response.f, problem.optimum, 1e-3 * std::abs(problem.optimum))
        << to_string(result.stop) << ": " << result.message;
    EXPECT_LE(result.violation, settings.feasibility);
    EXPECT_EQ(result.iterations, rows);
    // mma moves at most by the move limit. NLopt crosses its box from trial to trial: twice the
    // limit, and 1.5 times as much with nlopt_mma.
    if (GetParam() == "mma") {
      EXPECT_LE(largest_change, settings.move_limit * (1 + 1e-12));
    }
    if (GetParam().starts_with("nlopt")) {
      const double box = GetParam() == "nlopt_mma" ? 1.5 : 1;
      EXPECT_LE(largest_change, 2 * box * settings.move_limit * (1 + 1e-12));
    }
  }
}

TEST_P(EveryOptimizer, TakesTheSameWayTwice) {
  std::vector<VectorXd> first, second;
  for (std::vector<VectorXd>* way : {&first, &second}) {
    Analytic problem = hock_schittkowski_100();
    Settings settings = for_small_problems(GetParam());
    make_optimizer(settings)->minimize(problem, [&](const Iterate& it) {
      way->push_back(*it.x);
      return true;
    });
  }
  ASSERT_EQ(first.size(), second.size());
  for (size_t k = 0; k < first.size(); ++k) EXPECT_EQ(first[k], second[k]) << k;  // bit for bit
}

/// Rosenbrock's function inside a disc of radius² 1.5: min 100 (y - x²)² + (1 - x)².
class Valley final : public Analytic {
 public:
  Valley()
      : Analytic(
            "valley in a disc", VectorXd(Eigen::Vector2d(-2, -2)), VectorXd(Eigen::Vector2d(2, 2)),
            VectorXd(Eigen::Vector2d(-1, 0.6)), 1,
            [](const VectorXd& x, ProblemValues& r) {
              const double rise = x[1] - x[0] * x[0];
              r.f = 100 * rise * rise + (1 - x[0]) * (1 - x[0]);
              r.df << -400 * x[0] * rise - 2 * (1 - x[0]), 200 * rise;
              r.g[0] = x.squaredNorm() - 1.5;
              r.dg << 2 * x[0], 2 * x[1];
            },
            0) {}
  bool has_curvature() const override { return true; }
  MatrixXd curvature(const VectorXd& x, double sigma, const VectorXd& lambda) override {
    ++curvatures;
    MatrixXd out = 2 * lambda[0] * MatrixXd::Identity(2, 2);
    out(0, 0) += sigma * (1200 * x[0] * x[0] - 400 * x[1] + 2);
    out(1, 1) += 200 * sigma;
    out(0, 1) -= 400 * sigma * x[0];
    out(1, 0) -= 400 * sigma * x[0];
    return out;
  }
  int curvatures = 0;
};

// The optimum lies on the disc, beside the floor of the valley. Reference: x from Newton's method
// on the KKT conditions, written out here. Second derivatives are evaluated only with `exact`, and
// then fewer iterations are needed.
TEST(Ipopt, ConvergesQuadraticallyWithSecondDerivatives) {
  Eigen::Vector3d z(0.9, 0.8, 0.1);  // x, y, λ
  for (int step = 0; step < 20; ++step) {
    Valley v;
    const ProblemValues r = v.evaluate(z.head<2>());
    Eigen::Matrix3d K = Eigen::Matrix3d::Zero();
    K.topLeftCorner<2, 2>() = v.curvature(z.head<2>(), 1, z.tail<1>());
    K.topRightCorner<2, 1>() = r.dg.transpose();
    K.bottomLeftCorner<1, 2>() = r.dg;
    Eigen::Vector3d rest;
    rest << r.df + r.dg.transpose() * z[2], r.g[0];
    z -= K.partialPivLu().solve(rest);
  }
  ASSERT_GT(z[2], 0);
  std::array<int, 2> iterations{};
  for (const int exact : {0, 1}) {
    Valley valley;
    Settings settings = for_small_problems("ipopt");
    settings.kkt_tolerance = 1e-10;
    settings.options["exact"] = exact;
    const Result result = make_optimizer(settings)->minimize(valley, {});
    EXPECT_EQ(result.stop, Stop::converged) << result.message;
    EXPECT_LT((result.x - z.head<2>()).norm(), 1e-7);
    EXPECT_EQ(valley.curvatures > 0, exact == 1);
    iterations[static_cast<size_t>(exact)] = result.iterations;
  }
  EXPECT_LT(iterations[1], iterations[0]);
}

// An optimizer object keeps nothing of its previous run.
TEST_P(EveryOptimizer, CanBeUsedTwice) {
  const auto optimizer = make_optimizer(for_small_problems(GetParam()));
  Analytic problem = two_bar_truss();
  const Result first = optimizer->minimize(problem, {});
  Analytic other = cantilever();
  optimizer->minimize(other, {});
  const Result again = optimizer->minimize(problem, {});
  EXPECT_EQ(first.x, again.x);
  EXPECT_EQ(first.iterations, again.iterations);
}

// Bounds only: min Σ (x_j - t_j)² over [0, 1] with t outside for some variables, and one fixed
// variable.
TEST_P(EveryOptimizer, SolvesProblemsWithoutConstraintsAndWithFixedVariables) {
  const VectorXd target = Eigen::Vector4d(-0.5, 0.3, 1.7, 0.9);
  Analytic problem(
      "bounds only", VectorXd(Eigen::Vector4d(0, 0, 0, 0.4)),
      VectorXd(Eigen::Vector4d(1, 1, 1, 0.4)), VectorXd(Eigen::Vector4d(0.5, 0.5, 0.5, 0.4)), 0,
      [&](const VectorXd& x, ProblemValues& r) {
        r.f = (x - target).squaredNorm();
        r.df = 2 * (x - target);
      },
      0.25 + 0.49 + 0.25);
  const Result result = make_optimizer(for_small_problems(GetParam()))->minimize(problem, {});
  EXPECT_NEAR(result.response.f, problem.optimum, 1e-6) << result.message;
  EXPECT_EQ(result.x[3], 0.4);
  EXPECT_LE(result.kkt, 1e-5);
}

// The start violates the constraint (g = 11.6); the result must be feasible. NLopt uses its box
// here: without it, its curvatures grow with the first g and hardly decrease again.
TEST_P(EveryOptimizer, StartsFromAnInfeasibleDesign) {
  Analytic good = cantilever();
  Analytic problem(
      "infeasible start", good.lower(), good.upper(), VectorXd::Constant(5, 2), 1,
      [&](const VectorXd& x, ProblemValues& r) { r = good.evaluate(x); }, good.optimum);
  Settings settings = for_small_problems(GetParam());
  settings.options.erase("box");
  const Result result = make_optimizer(settings)->minimize(problem, {});
  EXPECT_NEAR(result.response.f, problem.optimum, 1e-4 * problem.optimum) << result.message;
  EXPECT_LE(result.violation, 1e-7);
}

INSTANTIATE_TEST_SUITE_P(Table, EveryOptimizer, ::testing::ValuesIn(optimizer_names()),
                         [](const auto& info) { return info.param; });

// The problems themselves are correct: optima as printed, and gradients of order two compared with
// differences.
TEST(Problems, OptimaAreThePrintedOnes) {
  EXPECT_NEAR(cantilever().optimum, 1.340, 5e-4);
  const VectorXd boxes = cantilever().solution;
  const double printed[] = {6.0160, 5.3092, 4.4943, 3.5015, 2.1527};
  // The printed x has f = 1.33996, 2e-6 above the optimum; the error of x is of the order of the
  // square root.
  for (int j = 0; j < 5; ++j) EXPECT_NEAR(boxes[j], printed[j], 5e-3);
  EXPECT_NEAR(two_bar_truss().optimum, 1.51, 5e-3);
  EXPECT_NEAR(two_bar_truss().solution[0], 1.41, 5e-3);
  EXPECT_NEAR(two_bar_truss().solution[1], 0.38, 5e-3);
  Analytic pyramid = eight_bar_truss();
  EXPECT_NEAR(pyramid.evaluate(pyramid.start()).f, 13.05, 5e-3);
  EXPECT_NEAR(pyramid.optimum, 11.23, 5e-3);
}

TEST(Problems, GradientsAreRight) {
  std::vector<Analytic> problems = published_problems();
  problems.push_back(many_bars(1000));
  for (Analytic& problem : problems) {
    SCOPED_TRACE(problem.name);
    const int n = problem.n_variables();
    const VectorXd& x = problem.published_start();
    VectorXd direction(n);
    for (int j = 0; j < n; ++j) direction[j] = std::cos(1.0 + 2 * j);
    const ProblemValues r = problem.evaluate(x);
    const auto order = [&](auto value, const VectorXd& gradient) {
      return taylor_test([&](const VectorXd& at) { return value(problem.evaluate(at)); }, gradient,
                         // sums of a thousand terms have more round-off
                         x, direction, 1e-2, 3, 1e-14)
          .order;
    };
    // Linear functions have no remainder, their order is infinite. An order above 1.95 counts as
    // second order.
    EXPECT_GT(order([](const ProblemValues& at) { return at.f; }, r.df), 1.95);
    for (int i = 0; i < problem.n_constraints(); ++i) {
      EXPECT_GT(order([i](const ProblemValues& at) { return 1 + at.g[i]; }, r.dg.row(i)), 1.95)
          << i;
    }
  }
}

// The approximations have the gradients of their functions, therefore an optimum is kept. Both
// gradients have entries of both signs: min (x - 2)² + (y + 1)² for x - y <= 1 at (1, 0).
// Inconsistent terms for increasing and decreasing functions would move it.
TEST(Mma, StaysAtAnOptimum) {
  for (const char* name : {"mma", "gcmma"}) {
    Analytic problem(
        "optimum", Vec2(-3, -3), Vec2(3, 3), Vec2(1, 0), 1,
        [](const VectorXd& x, ProblemValues& r) {
          r.f = (x[0] - 2) * (x[0] - 2) + (x[1] + 1) * (x[1] + 1);
          r.df = Vec2(2 * (x[0] - 2), 2 * (x[1] + 1));
          r.g[0] = x[0] - x[1] - 1;
          r.dg.row(0) = Vec2(1, -1).transpose();
        },
        2);
    Settings settings = for_small_problems(name);
    settings.max_iterations = 5;
    settings.kkt_tolerance = 0;
    const Result result = make_optimizer(settings)->minimize(problem, {});
    EXPECT_EQ(result.iterations, 5) << name << ": " << result.message;
    // tolerance of the subproblem
    EXPECT_LT((result.x - problem.start()).norm(), 1e-5) << name;
  }
}

// From a feasible iterate on, the iterates of gcmma stay feasible and never get worse, because
// every approximation lies above its function at the accepted point (up to the round-off of the
// subproblem).
TEST(Gcmma, StaysFeasibleAndFalls) {
  for (Analytic& problem : all_problems()) {
    SCOPED_TRACE(problem.name);
    Settings settings = for_small_problems("gcmma");
    bool feasible = false;
    double last = 0;
    make_optimizer(settings)->minimize(problem, [&](const Iterate& it) {
      if (feasible) {
        EXPECT_LE(it.violation, 1e-5);
        EXPECT_LE(it.response->f, last + 1e-6 * (1 + std::abs(last)));
      }
      feasible = it.violation <= 0;
      last = it.response->f;
      return it.iteration < 100;
    });
  }
}

}  // namespace
}  // namespace flexmorph::optim::test
