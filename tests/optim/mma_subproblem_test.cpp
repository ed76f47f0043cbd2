// Shows that solutions of the MMA subproblem satisfy its KKT conditions, which are evaluated here
// independently, and agree with a brute-force search; with many constraints, with none, and with
// constraints that cannot be satisfied.

#include "optim/mma_subproblem.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace flexmorph::optim::test {
namespace {

/// Returns a subproblem with random derivatives at x = 0, asymptotes at a distance of 0.1 and
/// bounds at 0.05.
MmaSubproblem random_subproblem(int n, int m, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  MmaSubproblem p;
  p.low = VectorXd::Constant(n, -0.1);
  p.upp = VectorXd::Constant(n, 0.1);
  p.alpha = VectorXd::Constant(n, -0.05);
  p.beta = VectorXd::Constant(n, 0.05);
  const auto fill = [&](auto&& a, auto&& b) {
    for (int j = 0; j < n; ++j) {
      const double slope = normal(generator);
      a[j] = 0.01 * (std::max(slope, 0.0) + 0.01);
      b[j] = 0.01 * (std::max(-slope, 0.0) + 0.01);
    }
  };
  p.p0.resize(n);
  p.q0.resize(n);
  fill(p.p0, p.q0);
  p.P.resize(n, m);
  p.Q.resize(n, m);
  for (int i = 0; i < m; ++i) fill(p.P.col(i), p.Q.col(i));
  p.b = 10 * (p.P + p.Q).colwise().sum().transpose();  // g = 0 at x = 0
  for (int i = 0; i < m; ++i) p.b[i] -= 0.01 * normal(generator);
  p.a = VectorXd::Zero(m);
  p.c = VectorXd::Constant(m, 1000);
  p.d = VectorXd::Ones(m);
  return p;
}

VectorXd constraint_values(const MmaSubproblem& p, const VectorXd& x) {
  return p.P.transpose() * (p.upp - x).cwiseInverse() +
         p.Q.transpose() * (x - p.low).cwiseInverse() - p.b;
}

double objective(const MmaSubproblem& p, const VectorXd& x) {
  return p.p0.dot((p.upp - x).cwiseInverse()) + p.q0.dot((x - p.low).cwiseInverse());
}

/// Returns the largest violation of the optimality conditions of the subproblem, with ξ and η
/// eliminated: a derivative with respect to x may point outwards only at a bound.
double kkt_from_statement(const MmaSubproblem& p, const MmaSolution& s) {
  const VectorXd u = (p.upp - s.x).cwiseInverse().array().square();
  const VectorXd l = (s.x - p.low).cwiseInverse().array().square();
  const VectorXd slope =
      (p.p0 + p.P * s.lambda).cwiseProduct(u) - (p.q0 + p.Q * s.lambda).cwiseProduct(l);
  double worst = 0;
  for (Eigen::Index j = 0; j < s.x.size(); ++j) {
    const double room = slope[j] > 0 ? s.x[j] - p.alpha[j] : p.beta[j] - s.x[j];
    EXPECT_GE(room, 0);
    worst = std::max(worst, std::min(std::abs(slope[j]), std::abs(slope[j]) * room / 1e-3));
  }
  const VectorXd g = constraint_values(p, s.x) - p.a * s.z - s.y;
  for (Eigen::Index i = 0; i < g.size(); ++i) {
    EXPECT_GE(s.lambda[i], 0);
    EXPECT_GE(s.y[i], 0);
    worst = std::max({worst, g[i], std::abs(s.lambda[i] * g[i])});
    const double in_y = p.c[i] + p.d[i] * s.y[i] - s.lambda[i];  // >= 0, and 0 where y > 0
    worst = std::max({worst, -in_y, std::abs(in_y * s.y[i])});
  }
  const double in_z = p.a0 - p.a.dot(s.lambda);
  return std::max({worst, -in_z, std::abs(in_z * s.z)});
}

TEST(MmaSubproblem, SolutionSatisfiesItsConditions) {
  for (const auto& [n, m] : {std::pair{2, 1}, {5, 3}, {672, 1}, {1120, 1}, {100, 20}, {10, 30}}) {
    MmaSolver solver(n, m);
    for (unsigned seed = 1; seed <= 5; ++seed) {
      MmaSubproblem p = random_subproblem(n, m, seed);
      if (seed == 5) p.a.setOnes();  // z takes part: a min-max problem
      const MmaSolution& s = solver.solve(p);
      EXPECT_TRUE(s.solved) << n << " " << m << " " << seed;
      EXPECT_LE(s.kkt, 2e-9);  // the last barrier parameter is 1e-9, residuals are below 0.9 of it
      // Products of complementary variables are at most 1e-9; distances to bounds are divided by
      // 1e-3 above.
      EXPECT_LE(kkt_from_statement(p, s), 5e-6) << n << " " << m << " " << seed;
    }
  }
}

/// Returns a worst case over m - 1 loads: m - 1 smoothly varying constraints below a bound, which
/// is a variable, and a volume constraint. All functions are at most zero at x = 0.
MmaSubproblem worst_case(int n, int m, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  MatrixXd shapes(n, 6);
  for (double& s : shapes.reshaped()) s = normal(generator) / 6;
  VectorXd df = VectorXd::Zero(n), slope(n);
  df[n - 1] = 100;
  MmaSubproblem p = random_subproblem(n, m, seed);
  const auto fill = [&](const VectorXd& slopes, auto&& a, auto&& b) {
    a = 0.01 * (1.001 * slopes.cwiseMax(0) + 0.001 * (-slopes).cwiseMax(0)).array() + 1e-4;
    b = 0.01 * (0.001 * slopes.cwiseMax(0) + 1.001 * (-slopes).cwiseMax(0)).array() + 1e-4;
  };
  fill(df, p.p0, p.q0);
  for (int i = 0; i < m; ++i) {
    const double t = i / (m - 1.0);
    const bool volume = i == m - 1;
    for (int j = 0; j < n; ++j) {
      slope[j] = volume ? 0.01 + 0.02 * std::abs(shapes(j, 0)) : -0.01 * std::abs(shapes(j, 1));
      for (int k = 0; k < 6 && !volume; ++k) slope[j] += 0.02 * shapes(j, k) * std::cos(3 * k * t);
    }
    slope[n - 1] = volume ? 0 : -10;
    fill(slope, p.P.col(i), p.Q.col(i));
    p.b[i] = 10 * (p.P.col(i) + p.Q.col(i)).sum() + (volume ? 0 : 0.3 * (1 + std::cos(9 * t)));
  }
  return p;
}

TEST(MmaSubproblem, ManyConstraintsSatisfyTheirConditionsInFewSteps) {
  for (const auto& [n, m] : {std::pair{672, 101}, {1120, 101}, {112, 101}, {60, 11}, {20, 101}}) {
    MmaSolver solver(n, m);
    for (unsigned seed = 1; seed <= 4; ++seed) {
      SCOPED_TRACE(std::to_string(n) + " " + std::to_string(m) + " " + std::to_string(seed));
      for (const MmaSubproblem& p : {worst_case(n, m, seed), random_subproblem(n, m, seed)}) {
        const MmaSolution& s = solver.solve(p);
        EXPECT_TRUE(s.solved);
        EXPECT_LE(s.kkt, 2e-9);
        EXPECT_LE(kkt_from_statement(p, s), 5e-6);
        // more steps mean that the predictor-corrector method stagnated
        EXPECT_LE(s.newton_steps, 40);
      }
    }
  }
}

// Min-max over 40 functions (a = 1): z is the largest of them, and the multipliers sum up to a0 =
// 1.
TEST(MmaSubproblem, MinMaxOfManyFunctions) {
  MmaSubproblem p = random_subproblem(30, 40, 6);
  p.p0.setConstant(1e-6);
  p.q0.setConstant(1e-6);
  p.a.setOnes();
  p.b.array() -= 1;  // so that z > 0
  MmaSolver solver(30, 40);
  const MmaSolution& s = solver.solve(p);
  EXPECT_TRUE(s.solved);
  EXPECT_NEAR(s.lambda.sum(), 1, 1e-8);
  EXPECT_NEAR(constraint_values(p, s.x).maxCoeff(), s.z, 1e-7);
  EXPECT_LE(kkt_from_statement(p, s), 5e-6);
}

// Three constraints are solved by the barrier method. Copies of them among many inactive
// constraints are solved by the predictor-corrector method: x must be equal, and multipliers are
// distributed over the copies.
TEST(MmaSubproblem, ManyConstraintsAgreeWithTheFewThatMatter) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const MmaSubproblem few = random_subproblem(50, 3, seed);
    const int m = 60;
    MmaSubproblem many = random_subproblem(50, m, seed + 100);
    many.p0 = few.p0;
    many.q0 = few.q0;
    many.b.array() += 100;
    for (int i = 0; i < 12; ++i) {
      many.P.col(5 * i) = few.P.col(i % 3);
      many.Q.col(5 * i) = few.Q.col(i % 3);
      many.b[5 * i] = few.b[i % 3];
    }
    MmaSolver solver_few(50, 3), solver_many(50, m);
    const MmaSolution& a = solver_few.solve(few);
    const MmaSolution& b = solver_many.solve(many);
    EXPECT_TRUE(a.solved && b.solved);
    // Both keep a distance of 1e-9 divided by the derivative from bounds; the smallest derivatives
    // are 1e-4.
    EXPECT_NEAR(objective(few, a.x), objective(few, b.x), 1e-7);
    EXPECT_LE((a.x - b.x).lpNorm<Eigen::Infinity>(), 2e-5) << seed;
    VectorXd shared = VectorXd::Zero(3);
    for (int i = 0; i < 12; ++i) shared[i % 3] += b.lambda[5 * i];
    EXPECT_LE((shared - a.lambda).lpNorm<Eigen::Infinity>(), 1e-5) << seed;
  }
}

TEST(MmaSubproblem, RepeatsBitForBit) {
  const MmaSubproblem p = worst_case(112, 101, 3), other = random_subproblem(112, 101, 4);
  MmaSolver first(112, 101), second(112, 101);
  second.solve(other);  // a solver keeps nothing of its previous problem
  const VectorXd x = first.solve(p).x;
  EXPECT_EQ(x, second.solve(p).x);
}

// Two variables and one constraint. Reference: the best point of a grid that is refined about its
// best point.
TEST(MmaSubproblem, AgreesWithBruteForce) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const MmaSubproblem p = random_subproblem(2, 1, seed);
    double best = 1e300;
    VectorXd best_x = VectorXd::Zero(2);
    const auto sweep = [&](double half) {
      const VectorXd centre = best_x;
      for (int i = -200; i <= 200; ++i) {
        for (int j = -200; j <= 200; ++j) {
          VectorXd x = centre + half / 200 * Eigen::Vector2d(i, j);
          x = x.cwiseMax(p.alpha).cwiseMin(p.beta);
          const double y = std::max(0.0, constraint_values(p, x)[0]);
          const double f = objective(p, x) + p.c[0] * y + 0.5 * p.d[0] * y * y;
          if (f < best) {
            best = f;
            best_x = x;
          }
        }
      }
    };
    for (const double half : {0.05, 2e-3, 1e-4, 1e-5, 1e-6}) sweep(half);
    MmaSolver solver(2, 1);
    const MmaSolution& s = solver.solve(p);
    const double f = objective(p, s.x) + p.c[0] * s.y[0] + 0.5 * p.d[0] * s.y[0] * s.y[0];
    // The last grid has a spacing of 5e-9; violations cost c = 1000, and derivatives are about 1.
    EXPECT_NEAR(f, best, 1e-6) << seed;
    EXPECT_LE(f, best + 1e-7) << seed;
  }
}

// A constraint that cannot be satisfied: y is the remaining violation, λ = c + d y, and x goes to
// its bounds.
TEST(MmaSubproblem, UnreachableConstraintsAreBought) {
  MmaSubproblem p = random_subproblem(20, 1, 3);
  p.b[0] -= 10;
  MmaSolver solver(20, 1);
  const MmaSolution& s = solver.solve(p);
  EXPECT_TRUE(s.solved);
  EXPECT_GT(s.y[0], 1);
  EXPECT_NEAR(s.lambda[0], p.c[0] + p.d[0] * s.y[0], 1e-6);
  EXPECT_NEAR(constraint_values(p, s.x)[0], s.y[0], 1e-8);
}

// A hundred constraints that cannot be satisfied, solved by the predictor-corrector method.
TEST(MmaSubproblem, ManyUnreachableConstraintsAreBought) {
  MmaSubproblem p = random_subproblem(20, 100, 3);
  p.b.array() -= 10;
  MmaSolver solver(20, 100);
  const MmaSolution& s = solver.solve(p);
  EXPECT_TRUE(s.solved);
  EXPECT_GT(s.y.minCoeff(), 1);
  EXPECT_LE((s.lambda - p.c - p.d.cwiseProduct(s.y)).lpNorm<Eigen::Infinity>(), 1e-6);
  EXPECT_LE((constraint_values(p, s.x) - s.y).lpNorm<Eigen::Infinity>(), 1e-8);
}

TEST(MmaSubproblem, WorksWithoutConstraints) {
  const MmaSubproblem p = random_subproblem(30, 0, 2);
  MmaSolver solver(30, 0);
  const MmaSolution& s = solver.solve(p);
  EXPECT_TRUE(s.solved);
  for (int j = 0; j < 30; ++j) {  // each variable by itself: √p0 (x - L) = √q0 (U - x)
    const double a = std::sqrt(p.p0[j]), b = std::sqrt(p.q0[j]);
    const double x = (a * p.low[j] + b * p.upp[j]) / (a + b);
    // The barrier keeps a distance of 1e-9 divided by the derivative from a bound; the derivative
    // there is at least 1e-4.
    EXPECT_NEAR(s.x[j], std::clamp(x, p.alpha[j], p.beta[j]), 1e-5) << j;
  }
}

}  // namespace
}  // namespace flexmorph::optim::test
