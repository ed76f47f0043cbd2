// Shows that the solver of large matrices that are symmetric except for a border solves: the Schur
// complement of the border and solutions (transposed, too) agree with a dense LU, with an
// unsymmetric block, constraints at an edge, pins inside and further bodies. Shows also that it
// finds the border, refuses unsuitable matrices, and gives equal bits after a restart from an
// archive.
#include "fem/solve/factorization/bordered_cholesky.h"

#include <gtest/gtest.h>

#include <random>

#include "fem/solve/factorization/multifrontal.h"
#include "fem/solve/linear_solver.h"
#include "tests/support/dense.h"

namespace flexmorph::fem {
namespace {

/// Lower triangle of the first n columns of a matrix.
struct Lower {
  std::vector<int> starts = {0}, rows;
  std::vector<double> values;

  Lower(const MatrixXd& a, int n) {
    for (int c = 0; c < n; ++c) {
      for (int r = c; r < a.rows(); ++r)
        if (a(r, c) != 0) {
          rows.push_back(r);
          values.push_back(a(r, c));
        }
      starts.push_back(static_cast<int>(rows.size()));
    }
  }
};

// The rows of the border are scattered, and some elimination trees have none: S = C - E K⁻¹ Eᵀ. The
// condition number is below 1e2.
TEST(Multifrontal, LeavesTheSchurComplementOfTheBorder) {
  constexpr int kInner = 60, kBorder = 7, kAll = kInner + kBorder;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> value(-1, 1);
  MatrixXd a = MatrixXd::Zero(kAll, kAll);
  for (int k = 0; k < kInner; ++k) {
    if (k % 13 != 12 && k + 1 < kInner) a(k + 1, k) = value(random);
    if (k + 9 < 40) a(k + 9, k) = value(random);
    if (k % 5 == 1 && k < 50) a(kInner + k % kBorder, k) = value(random);
  }
  a += MatrixXd(a.transpose());
  a.diagonal().setConstant(6);
  const Lower lower(a, kInner);
  Multifrontal factor(lower.starts, lower.rows);
  std::copy(lower.values.begin(), lower.values.end(), factor.values().begin());
  MatrixXd left(kBorder, kBorder);
  ASSERT_EQ(factor.factorize(&left), -1);
  const MatrixXd e = a.bottomLeftCorner(kBorder, kInner),
                 expected = -e * testing::solve(a.topLeftCorner(kInner, kInner), e.transpose());
  EXPECT_LT((left - expected).triangularView<Eigen::Lower>().toDenseMatrix().norm(), 1e-13);
}

/// Nodes of a grid with two unknowns each, coupled by springs along and across. Material may flow
/// through the first column of cells, and constraints may hold the first nodes or a node inside.
struct Strip {
  int nx = 50, ny = 16;
  double flow = 0.3;    ///< Factor of the unsymmetric entries.
  double strength = 1;  ///< Factor of the springs.
  bool weld = true, pin = true, rigid = true;

  int node(int i, int j) const { return 2 * (i * ny + j); }

  SparseMatrix matrix() const {
    std::vector<Eigen::Triplet<double>> t;
    const auto couple = [&](int a, int b, double k, double skew) {
      for (int c = 0; c < 2; ++c)
        for (int d = 0; d < 2; ++d) {
          const double part = k * (c == d ? 1 : 0.3);
          t.emplace_back(a + c, a + d, part);
          t.emplace_back(b + c, b + d, part);
          t.emplace_back(a + c, b + d, -part + skew * (1 + c));
          t.emplace_back(b + d, a + c, -part - skew * (1 + d));
        }
    };
    for (int i = 0; i < nx; ++i)
      for (int j = 0; j < ny; ++j) {
        for (int c = 0; c < 2; ++c) t.emplace_back(node(i, j) + c, node(i, j) + c, 0.02);
        const double k = strength * (1 + 0.5 * std::cos(i + 3 * j));
        if (i + 1 < nx) couple(node(i, j), node(i + 1, j), k, i == 0 ? flow : 0);
        if (j + 1 < ny) couple(node(i, j), node(i, j + 1), 0.7 * k, i < 2 ? 0.2 * flow : 0);
      }
    int n = 2 * nx * ny;
    if (rigid) {  // a rigid body that is joined to a corner of the free end
      for (int c = 0; c < 3; ++c) t.emplace_back(n + c, n + c, 3.0 + c);
      n += 3;
    }
    const auto constrain = [&](std::initializer_list<std::pair<int, double>> row) {
      for (const auto& [column, x] : row) {
        t.emplace_back(n, column, x);
        t.emplace_back(column, n, x);
      }
      ++n;
    };
    for (int j = 0; weld && j < ny; ++j)
      for (int c = 0; c < 2; ++c) constrain({{node(0, j) + c, 1}});
    if (pin) {
      constrain({{node(30, 7), 0.25}, {node(30, 8), 0.25}, {node(31, 7), 0.5}});
      constrain({{node(30, 7) + 1, 0.25}, {node(30, 8) + 1, 0.25}, {node(31, 7) + 1, 0.5}});
    }
    if (rigid) {
      const int body = 2 * nx * ny;
      constrain({{node(nx - 1, 0), 1}, {body, -1}, {body + 2, 0.4}});
      constrain({{node(nx - 1, 0) + 1, 1}, {body + 1, -1}});
    }
    SparseMatrix a(n, n);
    a.setFromTriplets(t.begin(), t.end());
    a.makeCompressed();
    return a;
  }
};

VectorXd some(Eigen::Index n) { return VectorXd::LinSpaced(n, -1, 2).array().cos(); }

/// Compares solutions with a dense LU; condition numbers are below 1e5.
void expect_solved(BorderedCholesky& solver, const SparseMatrix& a) {
  const VectorXd b = some(a.rows());
  const MatrixXd whole(a);
  const VectorXd expected = testing::solve(whole, b),
                 transposed = testing::solve(whole.transpose(), b);
  VectorXd x;
  solver.solve(b, x);
  EXPECT_LT((x - expected).norm(), 1e-10 * expected.norm());
  solver.solve(b, x, true);
  EXPECT_LT((x - transposed).norm(), 1e-10 * transposed.norm());
}

TEST(BorderedCholesky, SolvesWithAnUnsymmetricRootConstraintsAndOtherBodies) {
  for (const bool weld : {false, true})
    for (const bool others : {false, true}) {
      const SparseMatrix a = Strip{.weld = weld, .pin = others, .rigid = others}.matrix();
      BorderedCholesky solver;
      ASSERT_TRUE(solver.analyze(a));
      ASSERT_TRUE(solver.factorize(a));
      expect_solved(solver, a);
    }
}

// The first matrix is symmetric (like a mass matrix); the border grows when material flows.
TEST(BorderedCholesky, WidensItsBorderAndKeepsItsAnalysis) {
  BorderedCholesky solver;
  const SparseMatrix symmetric = Strip{.flow = 0, .weld = false}.matrix(),
                     flowing = Strip{.weld = false}.matrix();
  ASSERT_TRUE(solver.analyze(symmetric));
  for (const SparseMatrix* a : {&symmetric, &flowing, &symmetric}) {
    ASSERT_TRUE(solver.factorize(*a));
    expect_solved(solver, *a);
  }
}

/// Returns Q m Qᵀ, except for the entries between unknowns of the border, which remain those of m.
MatrixXd turned(const MatrixXd& m, const std::vector<char>& border, const TurnedVectors& turn) {
  MatrixXd q = MatrixXd::Identity(m.rows(), m.cols());
  for (int k = turn.first; k < turn.last; k += 2)
    q.block<2, 2>(k, k) << turn.cosine, -turn.sine, turn.sine, turn.cosine;
  MatrixXd out = q * m * q.transpose();
  for (int i = 0; i < m.rows(); ++i)
    for (int j = 0; j < m.cols(); ++j)
      if (border[static_cast<size_t>(i)] && border[static_cast<size_t>(j)]) out(i, j) = m(i, j);
  return out;
}

// The strip rotates by more than 90 degrees, and constraints and root have other values; the factor
// of the other unknowns is kept. A solver restored from an archive gives equal bits.
TEST(BorderedCholesky, TurnsAndRenewsItsBorder) {
  const Strip strip;
  SparseMatrix a = strip.matrix();
  DirectSolver solver;
  solver.analyze(a);
  solver.factorize(a);
  const std::vector<char> border = solver.border();
  ASSERT_EQ(border.size(), static_cast<size_t>(a.rows()));
  const int last = static_cast<int>(a.rows()) - 1, tip = strip.node(strip.nx - 1, 0);
  a.coeffRef(last, tip + 1) = 0.8;
  a.coeffRef(tip + 1, last) = 1.1;
  a.coeffRef(0, 2) += 0.1;
  const TurnedVectors turn{0, 2 * strip.nx * strip.ny, std::cos(1.9), std::sin(1.9)};
  ASSERT_TRUE(solver.renew_border(a, {turn}));
  const MatrixXd whole = turned(MatrixXd(a), border, turn);
  EXPECT_LT((MatrixXd(solver.as_solved(a)) - whole).norm(), 1e-13 * whole.norm());
  const VectorXd b = some(a.rows()), expected = testing::solve(whole, b),
                 transposed = testing::solve(whole.transpose(), b);
  VectorXd x, y;
  solver.solve_transposed(a, b, x);
  EXPECT_LT((x - transposed).norm(), 1e-10 * transposed.norm());
  solver.solve(a, b, x);
  EXPECT_LT((x - expected).norm(), 1e-10 * expected.norm());

  Archive taken;
  solver.archive(taken, a);
  Archive put(taken.bytes());
  DirectSolver again;
  again.archive(put, a);
  again.solve(a, b, y);
  EXPECT_EQ(x, y);
  // A new factorization has no rotation.
  solver.factorize(a);
  solver.solve(a, b, x);
  EXPECT_LT((a * x - b).norm(), 1e-12 * b.norm());
}

// A vector of which only one entry belongs to the border cannot be rotated with the rest.
TEST(BorderedCholesky, DoesNotTurnWhatTheBorderParts) {
  const Strip strip;
  const SparseMatrix a = strip.matrix();
  DirectSolver solver;
  solver.analyze(a);
  solver.factorize(a);
  EXPECT_FALSE(solver.renew_border(a, {{1, 2 * strip.nx * strip.ny - 1, 0, 1}}));
  EXPECT_TRUE(solver.border().empty());
  solver.factorize(a);
  EXPECT_FALSE(solver.border().empty());
}

TEST(BorderedCholesky, RefusesWhatIsUnsymmetricOrNotDefinite) {
  BorderedCholesky solver;
  SparseMatrix a = Strip{}.matrix();
  ASSERT_TRUE(solver.analyze(a));
  EXPECT_FALSE(solver.factorize(Strip{.strength = -1}.matrix()));
  // The matrix is unsymmetric everywhere.
  for (int column = 0; column < a.cols(); ++column)
    for (SparseMatrix::InnerIterator entry(a, column); entry; ++entry)
      if (entry.row() < column) entry.valueRef() *= 1.1;
  EXPECT_FALSE(solver.factorize(a));
  SparseMatrix one_way = Strip{}.matrix();
  one_way.coeffRef(100, 500) = 1e-3;
  one_way.makeCompressed();
  EXPECT_FALSE(solver.analyze(one_way));
}

// A solver restored from an archive continues with equal bits, also with a border that an earlier
// matrix has widened.
TEST(BorderedCholesky, RemembersItsBorder) {
  const SparseMatrix flowing = Strip{}.matrix(), other = Strip{.flow = 0}.matrix();
  DirectSolver solver, again;
  solver.analyze(flowing);
  solver.factorize(flowing);
  solver.factorize(other);
  Archive taken;
  solver.archive(taken, other);
  Archive put(taken.bytes());
  again.archive(put, other);
  const VectorXd b = some(other.rows());
  VectorXd x, y;
  solver.solve(other, b, x, false);
  again.solve(other, b, y, false);
  EXPECT_EQ(x, y);
  EXPECT_TRUE(solver.is_cholesky());
  // With refinement (the default) the solution is that of the whole matrix.
  solver.solve(other, b, x);
  EXPECT_LT((other * x - b).norm(), 1e-12 * b.norm());
  solver.solve_transposed(other, b, x);
  EXPECT_LT((other.transpose() * x - b).norm(), 1e-12 * b.norm());
}

}  // namespace
}  // namespace flexmorph::fem
