// Shows that the estimate of condition numbers agrees with exact ones and with dense inverses, and
// that it does not depend on units.

#include "fem/solve/condition.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <random>

#include "fem/solve/static_solver.h"

namespace flexmorph::fem {
namespace {

double norm1(const MatrixXd& a) { return a.cwiseAbs().colwise().sum().maxCoeff(); }

/// Returns the condition number in the 1-norm of a matrix scaled from both sides to a unit
/// diagonal.
double unit_condition(MatrixXd a) {
  const VectorXd d = a.diagonal().cwiseAbs().cwiseSqrt().cwiseInverse();
  a = (d.asDiagonal() * a * d.asDiagonal()).eval();
  return norm1(a) * norm1(a.inverse());
}

// For second differences of an odd number n of points, ‖T‖₁ = 4, and the middle column of T⁻¹ has
// the largest sum (n + 1)²/8.
TEST(Condition, OfSecondDifferencesIsExact) {
  for (const int n : {3, 9, 99}) {
    MatrixXd t = MatrixXd::Zero(n, n);
    t.diagonal().setConstant(2);
    t.diagonal(1).setConstant(-1);
    t.diagonal(-1).setConstant(-1);
    const double expected = 0.5 * (n + 1) * (n + 1);
    EXPECT_NEAR(condition_estimate(t.sparseView()), expected, 1e-10 * expected);
  }
}

// Hager's estimate is a lower bound, and seldom below a third of the exact value.
TEST(Condition, IsNearToThatOfTheDenseInverse) {
  std::mt19937 engine(3);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 20; ++k) {
    MatrixXd a(25, 25);
    for (Eigen::Index i = 0; i < a.size(); ++i) a(i) = normal(engine);
    const double exact = unit_condition(a), found = condition_estimate(a.sparseView());
    EXPECT_LE(found, exact * (1 + 1e-8));
    EXPECT_GE(found, exact / 3);
  }
}

// The condition number must not depend on mixed units such as millimetres and metres. The scales
// are powers of two, so that the scaled matrices have equal bits.
TEST(Condition, DoesNotDependOnUnits) {
  MatrixXd a(4, 4);  // a saddle point matrix
  a << 4, 1, 0, 1, 1, 3, 1, 0, 0, 1, 5, 2, 1, 0, 2, 0;
  const double own = condition_estimate(a.sparseView());
  VectorXd units(4);
  units << std::ldexp(1, 20), 1, std::ldexp(1, -20), std::ldexp(1, 40);
  const MatrixXd scaled = units.asDiagonal() * a * units.asDiagonal();
  EXPECT_NEAR(condition_estimate(scaled.sparseView()), own, 1e-12 * own);
  EXPECT_GT(own, 1);
  EXPECT_LT(own, 100);
}

TEST(Condition, IsInfiniteWhereNothingCanBeSolved) {
  const double none = std::numeric_limits<double>::infinity();
  EXPECT_EQ(condition_estimate(MatrixXd::Zero(3, 3).sparseView()), none);
  Eigen::Matrix2d a;
  a << 1, std::nan(""), 0, 1;
  EXPECT_EQ(condition_estimate(MatrixXd(a).sparseView(0.0, -1.0)), none);
  EXPECT_EQ(condition_estimate(SparseMatrix(0, 0)), 1);
}

/// Returns K of a solver from its solutions for unit loads.
template <class Solve>
MatrixXd stiffness_of(int n, const Solve& solve) {
  MatrixXd flexibility = MatrixXd::Identity(n, n);
  solve(flexibility);
  return flexibility.inverse();
}

// The diagonal of K must be found in the supernodes for any order of the unknowns; a nearly void
// row of cells raises the condition number.
TEST(Condition, OfPlatesIsThatOfTheirStiffness) {
  const Grid g{.x0 = 0, .y0 = 0, .width = 1.2, .height = 0.5, .nx = 9, .ny = 5};
  const PlaneSection section{0.02, 3e5, 0.3, 0};
  std::vector<HeldUnknown> held;
  for (int j = 0; j <= g.ny; ++j)
    for (int c = 0; c < 2; ++c) held.push_back({g.node(g.nx, j), c});
  StaticSolver plate(g, section, held);
  StaticSolver clamped(g, section);
  double last = 0;
  for (const double thin : {0.5, 1e-3, 1e-6}) {
    VectorXd factors = VectorXd::Ones(g.n_cells());
    for (int j = 0; j < g.ny; ++j) factors[g.cell(4, j)] = thin;
    plate.factorize(factors);
    clamped.factorize(factors);
    const MatrixXd k =
        stiffness_of(plate.n_unknowns(), [&](MatrixXd& loads) { plate.solve(loads); });
    const double exact = unit_condition(k);
    for (const double found : {plate.condition(), clamped.condition()}) {
      EXPECT_LE(found, exact * (1 + 1e-6));
      EXPECT_GE(found, exact / 3);
    }
    EXPECT_GT(exact, last);
    last = exact;
  }
  EXPECT_GT(last, 1e6);
}

// For elliptic equations of second order the condition number is O(1/dx²) (Bank & Scott 1989, SIAM
// J. Numer. Anal. 26, 1383-1394).
TEST(Condition, OfPlatesGrowsWithTheSquareOfTheMesh) {
  std::vector<double> found;
  for (const int n : {8, 16, 32}) {
    const Grid g{.x0 = 0, .y0 = 0, .width = 1, .height = 0.5, .nx = n, .ny = n / 2};
    StaticSolver solver(g, {0.02, 3e5, 0.3, 0});
    solver.factorize(VectorXd::Ones(g.n_cells()));
    found.push_back(solver.condition());
  }
  EXPECT_NEAR(std::log2(found[1] / found[0]), 2, 0.15);
  EXPECT_NEAR(std::log2(found[2] / found[1]), 2, 0.1);
}

}  // namespace
}  // namespace flexmorph::fem
