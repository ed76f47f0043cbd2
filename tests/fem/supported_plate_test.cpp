// Shows that static analyses of plates with any supports and any domain agree with Eigen's
// factorization of a matrix assembled here, a patch state, beam theory and symmetry; and that the
// matrix factor and its order of the nodes agree with dense algebra for patterns of any kind.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "fem/solve/factorization/grid_order.h"
#include "fem/solve/factorization/supernodal_factor.h"
#include "fem/solve/q4_cell.h"
#include "fem/solve/static_solver.h"
#include "tests/support/dense.h"

namespace flexmorph::fem {
namespace {

const PlaneSection kSoftPlate{0.02, 3e5, 0.3, 0};

std::vector<HeldUnknown> clamp_left(const Grid& g) {
  std::vector<HeldUnknown> held;
  for (int j = 0; j <= g.ny; ++j)
    for (int c = 0; c < 2; ++c) held.push_back({g.node(0, j), c});
  return held;
}

VectorXd random_factors(const Grid& g, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(0.01, 1);
  VectorXd f(g.n_cells());
  for (double& each : f) each = uniform(engine);
  return f;
}

/// Returns K over the unknowns of a solver, assembled cell by cell.
Eigen::SparseMatrix<double> assembled(const StaticSolver& solver, const VectorXd& factor,
                                      const std::vector<signed char>& outside) {
  const Grid& g = solver.grid();
  const auto cell = q4_stiffness(kSoftPlate, g.dx(), g.dy());
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < g.nx; ++i)
    for (int j = 0; j < g.ny; ++j) {
      const int index = g.cell(i, j);
      if (!outside.empty() && outside[static_cast<std::size_t>(index)]) continue;
      for (int a = 0; a < 8; ++a)
        for (int b = 0; b < 8; ++b) {
          const auto row = [&](int k) {
            const auto corner = static_cast<std::size_t>(k / 2);
            return solver.row(g.node(i + kCornerI[corner], j + kCornerJ[corner]), k % 2);
          };
          if (row(a) >= 0 && row(b) >= 0)
            entries.emplace_back(row(a), row(b), factor[index] * cell(a, b));
        }
    }
  Eigen::SparseMatrix<double> K(solver.n_unknowns(), solver.n_unknowns());
  K.setFromTriplets(entries.begin(), entries.end());
  return K;
}

// The plate is L-shaped, with rollers and a pin, random stiffness and several loads.
TEST(StaticSolver, AgreesWithAnotherFactorization) {
  const Grid g{.x0 = -1, .y0 = 2, .width = 1.2, .height = 1, .nx = 12, .ny = 10};
  std::vector<signed char> outside(static_cast<std::size_t>(g.n_cells()), 0);
  for (int i = 5; i < g.nx; ++i)
    for (int j = 4; j < g.ny; ++j) outside[static_cast<std::size_t>(g.cell(i, j))] = 1;
  std::vector<HeldUnknown> held;
  for (int i = 0; i <= 5; ++i) held.push_back({g.node(i, g.ny), 1});
  held.push_back({g.node(2, g.ny), 0});
  StaticSolver solver(g, kSoftPlate, held, outside);
  int nodes = 0;
  for (int i = 0; i <= g.nx; ++i)
    for (int j = 0; j <= g.ny; ++j) nodes += i <= 5 || j <= 4 ? 1 : 0;
  EXPECT_EQ(solver.n_unknowns(), 2 * nodes - 7);
  EXPECT_EQ(solver.row(g.node(9, 9), 0), -1);

  const VectorXd factor = random_factors(g, 1);
  solver.factorize(factor);
  std::srand(5);
  const MatrixXd loads = MatrixXd::Random(3, solver.n_unknowns());
  MatrixXd u = loads;
  solver.solve(u);
  const Eigen::SparseMatrix<double> K = assembled(solver, factor, outside);
  const MatrixXd expected = testing::solve(K, loads.transpose()).transpose();
  EXPECT_LT((u - expected).norm(), 1e-10 * expected.norm());

  // The energies of all cells add up to u . K u, for each load and for the weighted sum.
  MatrixXd each;
  VectorXd together;
  const Vec3 weights(0.5, 2, 1);
  solver.cell_energies(u, each);
  solver.cell_energies(u, weights, together);
  for (int l = 0; l < 3; ++l) {
    const double energy = expected.row(l) * K * expected.row(l).transpose();
    EXPECT_NEAR(each.row(l).dot(factor), energy, 1e-10 * energy);
  }
  EXPECT_LT((each.transpose() * weights - together).norm(), 1e-13 * together.norm());

  MatrixXd y = loads;
  solver.forward(y);
  EXPECT_NEAR(y.row(1).squaredNorm(), loads.row(1).dot(expected.row(1)),
              1e-10 * y.row(1).squaredNorm());
}

// A plate under uniform tension at both ends, held against rigid motion only, has the exact linear
// field.
TEST(StaticSolver, PassesThePatchTest) {
  const Grid g{.width = 2, .height = 1, .nx = 10, .ny = 6};
  StaticSolver solver(
      g, kSoftPlate,
      std::vector<HeldUnknown>{{g.node(0, 0), 0}, {g.node(0, 0), 1}, {g.node(g.nx, 0), 1}});
  solver.factorize(VectorXd::Ones(g.n_cells()));
  MatrixXd u = MatrixXd::Zero(1, solver.n_unknowns());
  const double pull = 7;  // total force [N]
  for (int j = 0; j <= g.ny; ++j) {
    const double share = pull / g.ny * (j == 0 || j == g.ny ? 0.5 : 1);
    u(0, solver.row(g.node(g.nx, j), 0)) += share;
    if (j > 0) u(0, solver.row(g.node(0, j), 0)) -= share;
  }
  solver.solve(u);
  const double strain = pull / (kSoftPlate.youngs_modulus * kSoftPlate.thickness * g.height);
  for (int i = 0; i <= g.nx; ++i)
    for (int j = 0; j <= g.ny; ++j)
      for (int c = 0; c < 2; ++c) {
        const int row = solver.row(g.node(i, j), c);
        const Vec2 X = g.node_position(i, j);
        const double exact = c == 0 ? strain * X.x() : -kSoftPlate.poisson_ratio * strain * X.y();
        if (row < 0) continue;
        EXPECT_NEAR(u(0, row), exact, 1e-12 * strain * g.width);
      }
}

// A slender cantilever under a tip force has Timoshenko's deflection, except for the effects of the
// ends, which the 0.5 % allow for.
TEST(StaticSolver, CantileverDeflectsLikeABeam) {
  const Grid g{.width = 10, .height = 1, .nx = 200, .ny = 20};
  StaticSolver solver(g, kSoftPlate, clamp_left(g));
  solver.factorize(VectorXd::Ones(g.n_cells()));
  MatrixXd u = MatrixXd::Zero(1, solver.n_unknowns());
  const int tip = solver.row(g.node(g.nx, g.ny / 2), 1);
  for (int j = 0; j <= g.ny; ++j)
    u(0, solver.row(g.node(g.nx, j), 1)) = 1.0 / g.ny * (j == 0 || j == g.ny ? 0.5 : 1);
  solver.solve(u);
  const double EI = kSoftPlate.youngs_modulus * kSoftPlate.thickness / 12;
  const double GA = kSoftPlate.youngs_modulus / 2.6 * kSoftPlate.thickness;
  const double beam = std::pow(g.width, 3) / (3 * EI) + g.width / (5. / 6 * GA);
  EXPECT_NEAR(u(0, tip), beam, 0.005 * beam);
}

// Half of a beam with rollers along the plane of symmetry moves like that half of the whole beam.
TEST(StaticSolver, RollersAreASymmetry) {
  const Grid whole{.x0 = -2, .width = 4, .height = 1, .nx = 40, .ny = 10};
  const Grid half{.width = 2, .height = 1, .nx = 20, .ny = 10};
  StaticSolver two(whole, kSoftPlate,
                   std::vector<HeldUnknown>{
                       {whole.node(0, 0), 1}, {whole.node(40, 0), 1}, {whole.node(20, 0), 0}});
  std::vector<HeldUnknown> rollers{{half.node(20, 0), 1}};
  for (int j = 0; j <= 10; ++j) rollers.push_back({half.node(0, j), 0});
  StaticSolver one(half, kSoftPlate, rollers);
  two.factorize(VectorXd::Ones(whole.n_cells()));
  one.factorize(VectorXd::Ones(half.n_cells()));
  MatrixXd u2 = MatrixXd::Zero(1, two.n_unknowns()), u1 = MatrixXd::Zero(1, one.n_unknowns());
  u2(0, two.row(whole.node(20, 10), 1)) = -2;
  u1(0, one.row(half.node(0, 10), 1)) = -1;
  two.solve(u2);
  one.solve(u1);
  const double scale = u1.cwiseAbs().maxCoeff();
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j <= 10; ++j)
      EXPECT_NEAR(u1(0, one.row(half.node(i, j), 1)), u2(0, two.row(whole.node(20 + i, j), 1)),
                  1e-9 * scale);
}

TEST(StaticSolver, RefusesPlatesThatFloat) {
  const Grid g{.width = 2, .height = 1, .nx = 8, .ny = 4};
  StaticSolver turning(g, kSoftPlate,
                       std::vector<HeldUnknown>{{g.node(0, 0), 0}, {g.node(0, 0), 1}});
  EXPECT_THROW(turning.factorize(VectorXd::Ones(g.n_cells())), Error);
  StaticSolver held(g, kSoftPlate, clamp_left(g));
  EXPECT_NO_THROW(held.factorize(VectorXd::Ones(g.n_cells())));
  VectorXd wrong = VectorXd::Ones(g.n_cells());
  wrong[3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(held.factorize(wrong), Error);
  EXPECT_THROW(StaticSolver(g, kSoftPlate, std::vector<HeldUnknown>{{1000, 0}}), Error);
}

// Every node occurs once, and the first separator, the column of nodes in the middle, comes after
// both halves.
TEST(DissectionOrder, IsAPermutationThatEndsWithTheFirstCut) {
  for (const Grid& g : {Grid{.nx = 13, .ny = 5}, Grid{.nx = 1, .ny = 1}, Grid{.nx = 7, .ny = 2}}) {
    const std::vector<int> order = dissection_order(g);
    std::vector<int> times(static_cast<std::size_t>(g.n_nodes()), 0);
    for (const int node : order) ++times[static_cast<std::size_t>(node)];
    EXPECT_EQ(times, std::vector<int>(times.size(), 1));
    if (g.nx < 2) continue;
    for (int j = 0; j <= g.ny; ++j)
      EXPECT_EQ(order[order.size() - 1 - static_cast<std::size_t>(j)],
                g.node((g.nx + 1) / 2, g.ny - j));
  }
}

/// Lower triangle of a symmetric matrix in compressed columns.
struct Lower {
  std::vector<int> starts = {0}, rows;
  std::vector<double> values;
  explicit Lower(const MatrixXd& K) {
    for (int c = 0; c < K.cols(); ++c) {
      for (int r = c; r < K.rows(); ++r)
        if (K(r, c) != 0) {
          rows.push_back(r);
          values.push_back(K(r, c));
        }
      starts.push_back(static_cast<int>(rows.size()));
    }
  }
};

SupernodalFactor factor_of(const Lower& K) {
  SupernodalFactor out(K.starts, K.rows);
  std::copy(K.values.begin(), K.values.end(), out.values().begin());
  return out;
}

/// Returns a matrix with a random pattern of n unknowns in three uncoupled groups and a dominant
/// diagonal.
MatrixXd scattered(int n, unsigned seed, double filling) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  MatrixXd K = MatrixXd::Zero(n, n);
  for (int c = 0; c < n; ++c)
    for (int r = c + 1; r < n; ++r)
      if (r % 3 == c % 3 && std::abs(uniform(engine)) < filling)
        K(r, c) = K(c, r) = uniform(engine);
  for (int c = 0; c < n; ++c) K(c, c) = 1 + K.col(c).cwiseAbs().sum();
  return K;
}

// The elimination trees have every shape: several roots, leaves, long chains, wide blocks (the
// dense factor divides blocks above 16 columns). One load takes another code path than several.
TEST(SupernodalFactor, AgreesWithADenseFactorizationForAnyPattern) {
  std::srand(11);
  for (unsigned seed = 1; seed <= 30; ++seed) {
    const int n = 150;
    const MatrixXd K = scattered(n, seed, 0.002 * std::pow(1.2, seed));
    SupernodalFactor factor = factor_of(Lower(K));
    ASSERT_EQ(factor.factorize(), -1);
    for (const int n_loads : {1, 5}) {
      const MatrixXd loads = MatrixXd::Random(n_loads, n);
      const std::vector<int> active(static_cast<std::size_t>(n_loads), n);
      MatrixXd x = loads;
      factor.forward(x, active);
      factor.backward(x, active);
      // The matrix is diagonally dominant; therefore its condition number is small and only
      // round-off of n terms remains.
      EXPECT_LT((x * K - loads).norm(), 1e-13 * K.norm() * x.norm()) << seed;
    }
  }
}

TEST(SupernodalFactor, NamesTheColumnWithoutAPositivePivotAndRecovers) {
  const MatrixXd K = scattered(60, 3, 0.05);
  const Lower sound(K);
  SupernodalFactor factor = factor_of(sound);
  for (const int column : {0, 17, 59}) {
    factor.values()[static_cast<std::size_t>(sound.starts[static_cast<std::size_t>(column)])] = -1;
    EXPECT_EQ(factor.factorize(), column);
    std::copy(sound.values.begin(), sound.values.end(), factor.values().begin());
    EXPECT_EQ(factor.factorize(), -1);
  }
}

// Equal matrices must give equal bits, independent of previous factorizations.
TEST(StaticSolver, RepeatsItselfBitForBit) {
  const Grid g{.width = 3, .height = 1, .nx = 30, .ny = 10};
  StaticSolver solver(g, kSoftPlate, clamp_left(g));
  std::srand(3);
  const MatrixXd loads = MatrixXd::Random(4, solver.n_unknowns());
  MatrixXd first = loads, again = loads;
  solver.factorize(random_factors(g, 1));
  solver.solve(first);
  solver.factorize(random_factors(g, 2));
  solver.factorize(random_factors(g, 1));
  solver.solve(again);
  EXPECT_TRUE((first.array() == again.array()).all());
}

// On a mesh that is large enough for wide blocks, one load and several loads must satisfy K u = F
// with K assembled by cells.
TEST(StaticSolver, SolvesWhatWasAskedOnALargerMesh) {
  const Grid g{.width = 2, .height = 1, .nx = 60, .ny = 31};
  StaticSolver solver(g, kSoftPlate, clamp_left(g));
  const VectorXd factor = random_factors(g, 4);
  solver.factorize(factor);
  const Eigen::SparseMatrix<double> K = assembled(solver, factor, {});
  std::srand(4);
  for (const int n_loads : {1, 7}) {
    const MatrixXd loads = MatrixXd::Random(n_loads, solver.n_unknowns());
    MatrixXd u = loads;
    solver.solve(u);
    // The solution is backward stable: the residual is round-off of K u for any condition number of
    // K.
    EXPECT_LT((u * K - loads).norm(), 1e-14 * K.norm() * u.norm());
  }
}

}  // namespace
}  // namespace flexmorph::fem
