// Shows that the KKT residual is zero at known optima and only there, and that its multipliers are
// those of an independent solution.

#include "optim/kkt.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "optim/optimizer.h"
#include "tests/optim/problems.h"

namespace flexmorph::optim::test {
namespace {

TEST(KktResidual, VanishesAtKnownOptimaOnly) {
  for (Analytic& problem : all_problems()) {
    if (problem.solution.size() == 0) continue;
    SCOPED_TRACE(problem.name);
    const VectorXd lower = problem.lower(), upper = problem.upper();
    const ProblemValues r = problem.evaluate(problem.solution);
    EXPECT_NEAR(r.f, problem.optimum, 1e-12 * (1 + std::abs(r.f)));
    // Solutions are exact or bisected to round-off; gradients are below 100.
    EXPECT_LE(kkt_residual(r, problem.solution, lower, upper), 1e-11);

    const VectorXd start = problem.start();
    EXPECT_GT(kkt_residual(problem.evaluate(start), start, lower, upper), 1e-4);
    const VectorXd near = (problem.solution + 0.05 * (start - problem.solution));
    EXPECT_GT(kkt_residual(problem.evaluate(near), near, lower, upper), 1e-5);
  }
}

// HS43: the first and third constraints are active, with multipliers 1 and 2.
TEST(KktResidual, MultipliersOfHockSchittkowski43) {
  Analytic problem = hock_schittkowski_43();
  const KktPoint kkt = kkt_point(problem.evaluate(problem.solution), problem.solution,
                                 problem.lower(), problem.upper(), 1e-4);
  EXPECT_NEAR(kkt.lambda[0], 1, 1e-12);
  EXPECT_EQ(kkt.lambda[1], 0);  // inactive by 1
  EXPECT_NEAR(kkt.lambda[2], 2, 1e-12);
}

// Multipliers are not negative: a constraint whose gradient has the wrong direction does not reduce
// the residual.
TEST(KktResidual, NegativeMultipliersAreNotUsed) {
  ProblemValues r;
  r.df = Eigen::Vector2d(1, 0);
  r.g = VectorXd::Zero(1);
  r.dg = Eigen::RowVector2d(1, 0);
  const VectorXd x = VectorXd::Zero(2), lower = VectorXd::Constant(2, -1),
                 upper = VectorXd::Constant(2, 1);
  EXPECT_EQ(kkt_residual(r, x, lower, upper), 1);
  r.dg = Eigen::RowVector2d(-2, 0);
  EXPECT_NEAR(kkt_residual(r, x, lower, upper), 0, 1e-15);
  r.g[0] = -0.1;  // not active
  EXPECT_EQ(kkt_residual(r, x, lower, upper), 1);
}

TEST(KktResidual, BoundsDropEntriesThatPushAgainstThem) {
  ProblemValues r;
  r.df = Eigen::Vector3d(2, -3, 0.5);
  r.g = VectorXd();
  r.dg = MatrixXd(0, 3);
  const VectorXd lower = VectorXd::Zero(3), upper = VectorXd::Ones(3);
  EXPECT_EQ(kkt_residual(r, Eigen::Vector3d(0, 1, 0), lower, upper), 0);
  EXPECT_EQ(kkt_residual(r, Eigen::Vector3d(1, 0, 0), lower, upper), 3);
  EXPECT_EQ(kkt_residual(r, Eigen::Vector3d(0, 1, 0.5), lower, upper), 0.5);
}

// Which bounds are active depends on the multiplier: the linear program min -x₁ - 3 x₂, x₁ + x₂ <=
// 1, x in [0, 1]² has its optimum at (0, 1), with a multiplier between 1 and 3.
TEST(KktResidual, BoundsAndConstraintsTogether) {
  ProblemValues r;
  r.df = Eigen::Vector2d(-1, -3);
  r.g = VectorXd::Zero(1);
  r.dg = Eigen::RowVector2d(1, 1);
  const VectorXd lower = VectorXd::Zero(2), upper = VectorXd::Ones(2);
  EXPECT_NEAR(kkt_residual(r, Eigen::Vector2d(0, 1), lower, upper), 0, 1e-14);
  EXPECT_GE(kkt_residual(r, Eigen::Vector2d(1, 0), lower, upper), 0.5);
}

// Checks the optimality conditions of the solution on random problems, some with dependent
// constraints.
TEST(NonnegativeMinimum, SatisfiesItsConditions) {
  std::mt19937 generator(7);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 200; ++trial) {
    const int m = 1 + trial % 12, n = 1 + (trial * 7) % 20;  // n < m: dependent rows
    MatrixXd A(m, n);
    VectorXd h(n);
    for (double& a : A.reshaped()) a = normal(generator);
    for (double& v : h) v = normal(generator);
    const MatrixXd G = A * A.transpose();
    const VectorXd b = A * h;
    const VectorXd lambda = nonnegative_minimum(G, b);
    const VectorXd slope = G * lambda - b;
    const double scale = 1e-9 * (1 + G.norm() * lambda.norm());
    EXPECT_GE(lambda.minCoeff(), 0);
    EXPECT_GE(slope.minCoeff(), -scale) << trial;
    EXPECT_LE(lambda.cwiseProduct(slope).cwiseAbs().maxCoeff(), scale * (1 + lambda.maxCoeff()))
        << trial;
  }
}

}  // namespace
}  // namespace flexmorph::optim::test
