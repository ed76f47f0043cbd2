// Shows that both methods of the linear solver solve: residuals and dense LU on matrices of
// dynamics with and without symmetry; that matrices unsuitable for Cholesky go to UMFPACK; and that
// singular and NaN matrices are refused.
#include "fem/solve/linear_solver.h"

#include <gtest/gtest.h>

#include <limits>

#include "fem/solve/factorization/substitution.h"
#include "tests/support/dense.h"

namespace flexmorph::fem {
namespace {

/// A matrix [A Bᵀ; B 0]: A of a chain of n masses and springs, B couples some of them by
/// constraints.
struct Saddle {
  int n = 40, m = 3;
  double mass = 1, spring = 0.7, skew = 0, twice = 0;

  SparseMatrix matrix() const {
    std::vector<Eigen::Triplet<double>> t;
    for (int i = 0; i < n; ++i) {
      t.emplace_back(i, i, mass + 2 * spring);
      if (i + 1 < n) {
        t.emplace_back(i, i + 1, -spring + skew);
        t.emplace_back(i + 1, i, -spring - skew);
      }
    }
    for (int k = 0; k < m; ++k)
      for (int i = k; i < n; i += 7 + k) {
        // With `twice` the last constraint is a copy of the first.
        const int from = twice != 0 && k == m - 1 ? 0 : k;
        const double value = from == k ? 0.5 + 0.1 * i : 0;
        t.emplace_back(n + k, i, value);
        t.emplace_back(i, n + k, value);
      }
    SparseMatrix a(n + m, n + m);
    a.setFromTriplets(t.begin(), t.end());
    a.makeCompressed();
    return a;
  }
};

void expect_solved(DirectSolver& solver, const SparseMatrix& a, bool refine) {
  const VectorXd b = VectorXd::LinSpaced(a.rows(), -1, 2).array().cos();
  const VectorXd expected = testing::solve(MatrixXd(a), b);
  VectorXd x;
  solver.solve(a, b, x, refine);
  // The condition number is below 1e3, so that thirteen digits remain.
  EXPECT_LT((x - expected).norm(), 1e-12 * expected.norm());
  EXPECT_LT((a * x - b).norm(), 1e-13 * b.norm());
  const VectorXd transposed = testing::solve(MatrixXd(a).transpose(), b);
  solver.solve_transposed(a, b, x, refine);
  EXPECT_LT((x - transposed).norm(), 1e-12 * transposed.norm());
  EXPECT_LT((a.transpose() * x - b).norm(), 1e-13 * b.norm());
}

// Substitution with a block of columns is compared with the columns in a whole dense triangle, for
// widths and heights that are and are not multiples of four and eight. The tolerance is about ten
// times round-off.
TEST(LinearSolver, SubstitutionThroughABlockIsThatOfTheTriangle) {
  for (int width = 1; width <= 21; ++width)
    for (const int below : {0, 1, 5, 8, 19}) {
      const int height = width + below;
      MatrixXd block = MatrixXd::Random(height, width) / height;
      block.diagonal().array() += 2;
      MatrixXd whole = MatrixXd::Identity(height, height);
      whole.leftCols(width) = block.triangularView<Eigen::Lower>();
      const VectorXd b = VectorXd::LinSpaced(height, -1, 2).array().cos();
      VectorXd y = b;
      forward_block(block.data(), width, height, y.data());
      EXPECT_LT((whole * y - b).norm(), 1e-15 * height);
      y = b;
      backward_block(block.data(), width, height, y.data());
      EXPECT_LT((whole.transpose() * y - b).norm(), 1e-15 * height);
      EXPECT_EQ(y.tail(below), b.tail(below));
    }
}

TEST(LinearSolver, SymmetricByCholeskyAndOthersByUmfpack) {
  for (const double skew : {0.0, 0.2})
    for (const int m : {0, 1, 3}) {
      const SparseMatrix a = Saddle{.m = m, .skew = skew}.matrix();
      DirectSolver solver;
      solver.analyze(a);
      solver.factorize(a);
      EXPECT_EQ(solver.is_cholesky(), skew == 0);
      for (const bool refine : {false, true}) expect_solved(solver, a, refine);
    }
}

// One solver gets one matrix after the other: symmetric, with flow, not positive definite.
TEST(LinearSolver, ChoosesAtEveryFactorization) {
  DirectSolver solver;
  solver.analyze(Saddle{}.matrix());
  const auto is_cholesky = [&](const Saddle& s) {
    const SparseMatrix a = s.matrix();
    solver.factorize(a);
    expect_solved(solver, a, true);
    return solver.is_cholesky();
  };
  EXPECT_TRUE(is_cholesky({}));
  EXPECT_FALSE(is_cholesky({.skew = 0.1}));
  EXPECT_FALSE(is_cholesky({.mass = -1.5}));
  EXPECT_TRUE(is_cholesky({.spring = 0.3}));
}

// Material flow makes tangents slightly unsymmetric. If an outer iteration permits a relative
// error, the symmetric part replaces the matrix: the constraints are still satisfied, the error of
// x is below the limit, and repeated solution for the residual (as the outer iteration does)
// reduces the error each time.
TEST(LinearSolver, NearlySymmetricByTheSymmetricPartWhereAskedFor) {
  constexpr double kMiss = 0.02;
  DirectSolver solver;
  const SparseMatrix a = Saddle{.skew = 0.003}.matrix();
  const int n = Saddle{}.n, m = Saddle{}.m;
  solver.analyze(a);
  solver.factorize(a);
  EXPECT_FALSE(solver.is_cholesky());
  expect_solved(solver, a, false);
  solver.factorize(Saddle{.skew = 0.1}.matrix(), kMiss);  // after one refusal ...
  EXPECT_FALSE(solver.is_cholesky());
  solver.factorize(a, kMiss);  // ... the symmetric part is not tried again
  EXPECT_FALSE(solver.is_cholesky());
  solver.analyze(a);
  solver.factorize(a, kMiss);
  ASSERT_TRUE(solver.is_cholesky());
  const VectorXd b = VectorXd::LinSpaced(n + m, -1, 2).array().cos();
  const VectorXd expected = testing::solve(MatrixXd(a), b);
  VectorXd x, step;
  solver.solve(a, b, x, false);
  EXPECT_LT((a * x - b).tail(m).norm(), 1e-13 * b.norm());
  double missed = (x - expected).head(n).norm();
  EXPECT_GT(missed, 1e-5 * expected.head(n).norm());
  EXPECT_LT(missed, kMiss * expected.head(n).norm());
  for (int k = 0; k < 3; ++k) {
    solver.solve(a, b - a * x, step, false);
    x += step;
    const double now = (x - expected).head(n).norm();
    EXPECT_LT(now, kMiss * missed);
    missed = now;
  }
}

// A matrix too far from symmetric is factorized as a whole. Where Φ_q and Φ_qᵀ differ, their
// unknowns belong to the border, which is solved without symmetry.
TEST(LinearSolver, FarFromSymmetricInAnyCaseByUmfpack) {
  DirectSolver solver;
  SparseMatrix a = Saddle{.skew = 0.1}.matrix();
  solver.analyze(a);
  solver.factorize(a, 0.02);
  EXPECT_FALSE(solver.is_cholesky());
  expect_solved(solver, a, false);
  a = Saddle{}.matrix();
  a.coeffRef(Saddle{}.n, 0) *= 1.001;
  solver.factorize(a, 0.02);
  EXPECT_TRUE(solver.is_cholesky());
  expect_solved(solver, a, false);
}

// A free chain is singular; with its constraint it is not.
TEST(LinearSolver, BodyHeldByConstraintsOnly) {
  std::vector<Eigen::Triplet<double>> t;
  const int n = 10;
  for (int i = 0; i + 1 < n; ++i)
    for (const auto& [r, c, v] :
         {std::tuple{i, i, 1.0}, {i + 1, i + 1, 1.0}, {i, i + 1, -1.0}, {i + 1, i, -1.0}})
      t.emplace_back(r, c, v);
  t.emplace_back(n, 0, 1.0);
  t.emplace_back(0, n, 1.0);
  SparseMatrix a(n + 1, n + 1);
  a.setFromTriplets(t.begin(), t.end());
  a.makeCompressed();
  DirectSolver solver;
  solver.analyze(a);
  solver.factorize(a);
  EXPECT_TRUE(solver.is_cholesky());  // the unknowns around the constraint are in the border
  expect_solved(solver, a, true);
}

TEST(LinearSolver, RefusesSingularAndNotFinite) {
  for (const double skew : {0.0, 0.2}) {
    const SparseMatrix singular = Saddle{.skew = skew, .twice = 1}.matrix();
    DirectSolver solver;
    solver.analyze(singular);
    EXPECT_THROW(solver.factorize(singular), Error);
    SparseMatrix a = Saddle{.skew = skew}.matrix();
    solver.analyze(a);
    a.valuePtr()[5] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(solver.factorize(a), Error);
  }
}

}  // namespace
}  // namespace flexmorph::fem
