// Static analysis of a plate at rest with any supports and any domain: against Eigen's
// factorization of a matrix assembled here, a patch state, beam theory and symmetry.

#include "fem/solve/plate_solver.h"

#include <gtest/gtest.h>

#include <Eigen/SparseCholesky>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "fem/solve/q4_cell.h"

namespace flexmorph::fem {
namespace {

const PlaneSection kSection{0.02, 3e5, 0.3, 0};

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

/// K over the unknowns of a solver, assembled cell by cell.
Eigen::SparseMatrix<double> assembled(const PlateSolver& solver, const VectorXd& factor,
                                      const std::vector<signed char>& outside) {
  const Grid& g = solver.grid();
  const auto cell = q4_stiffness(kSection, g.dx(), g.dy());
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

// An L with a roller and a pin, stiffness at random, several loads.
TEST(PlateSolver, AgreesWithAnotherFactorization) {
  const Grid g{.x0 = -1, .y0 = 2, .width = 1.2, .height = 1, .nx = 12, .ny = 10};
  std::vector<signed char> outside(static_cast<std::size_t>(g.n_cells()), 0);
  for (int i = 5; i < g.nx; ++i)
    for (int j = 4; j < g.ny; ++j) outside[static_cast<std::size_t>(g.cell(i, j))] = 1;
  std::vector<HeldUnknown> held;
  for (int i = 0; i <= 5; ++i) held.push_back({g.node(i, g.ny), 1});
  held.push_back({g.node(2, g.ny), 0});
  PlateSolver solver(g, kSection, held, outside);
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
  const MatrixXd expected =
      Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(K).solve(loads.transpose()).transpose();
  EXPECT_LT((u - expected).norm(), 1e-10 * expected.norm());

  // Energies of all cells add up to u . K u, load by load and together.
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

// Pulled at both ends by its own stress, held against rigid motion only: the exact linear field.
TEST(PlateSolver, PassesThePatchTest) {
  const Grid g{.width = 2, .height = 1, .nx = 10, .ny = 6};
  PlateSolver solver(
      g, kSection,
      std::vector<HeldUnknown>{{g.node(0, 0), 0}, {g.node(0, 0), 1}, {g.node(g.nx, 0), 1}});
  solver.factorize(VectorXd::Ones(g.n_cells()));
  MatrixXd u = MatrixXd::Zero(1, solver.n_unknowns());
  const double pull = 7;  // [N] in all
  for (int j = 0; j <= g.ny; ++j) {
    const double share = pull / g.ny * (j == 0 || j == g.ny ? 0.5 : 1);
    u(0, solver.row(g.node(g.nx, j), 0)) += share;
    if (j > 0) u(0, solver.row(g.node(0, j), 0)) -= share;
  }
  solver.solve(u);
  const double strain = pull / (kSection.youngs_modulus * kSection.thickness * g.height);
  for (int i = 0; i <= g.nx; ++i)
    for (int j = 0; j <= g.ny; ++j)
      for (int c = 0; c < 2; ++c) {
        const int row = solver.row(g.node(i, j), c);
        const Vec2 X = g.node_position(i, j);
        const double exact = c == 0 ? strain * X.x() : -kSection.poisson_ratio * strain * X.y();
        if (row < 0) continue;
        EXPECT_NEAR(u(0, row), exact, 1e-12 * strain * g.width);
      }
}

// A slender cantilever under a tip force: Timoshenko's deflection, up to what the ends do.
TEST(PlateSolver, CantileverDeflectsLikeABeam) {
  const Grid g{.width = 10, .height = 1, .nx = 200, .ny = 20};
  PlateSolver solver(g, kSection, clamp_left(g));
  solver.factorize(VectorXd::Ones(g.n_cells()));
  MatrixXd u = MatrixXd::Zero(1, solver.n_unknowns());
  const int tip = solver.row(g.node(g.nx, g.ny / 2), 1);
  for (int j = 0; j <= g.ny; ++j)
    u(0, solver.row(g.node(g.nx, j), 1)) = 1.0 / g.ny * (j == 0 || j == g.ny ? 0.5 : 1);
  solver.solve(u);
  const double EI = kSection.youngs_modulus * kSection.thickness / 12;
  const double GA = kSection.youngs_modulus / 2.6 * kSection.thickness;
  const double beam = std::pow(g.width, 3) / (3 * EI) + g.width / (5. / 6 * GA);
  EXPECT_NEAR(u(0, tip), beam, 0.005 * beam);
}

// Half of a beam with a roller along the plane of symmetry moves like the half of the whole.
TEST(PlateSolver, RollersAreASymmetry) {
  const Grid whole{.x0 = -2, .width = 4, .height = 1, .nx = 40, .ny = 10};
  const Grid half{.width = 2, .height = 1, .nx = 20, .ny = 10};
  PlateSolver two(whole, kSection,
                  std::vector<HeldUnknown>{
                      {whole.node(0, 0), 1}, {whole.node(40, 0), 1}, {whole.node(20, 0), 0}});
  std::vector<HeldUnknown> rollers{{half.node(20, 0), 1}};
  for (int j = 0; j <= 10; ++j) rollers.push_back({half.node(0, j), 0});
  PlateSolver one(half, kSection, rollers);
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

TEST(PlateSolver, RefusesPlatesThatFloat) {
  const Grid g{.width = 2, .height = 1, .nx = 8, .ny = 4};
  PlateSolver turning(g, kSection, std::vector<HeldUnknown>{{g.node(0, 0), 0}, {g.node(0, 0), 1}});
  EXPECT_THROW(turning.factorize(VectorXd::Ones(g.n_cells())), Error);
  PlateSolver held(g, kSection, clamp_left(g));
  EXPECT_NO_THROW(held.factorize(VectorXd::Ones(g.n_cells())));
  VectorXd wrong = VectorXd::Ones(g.n_cells());
  wrong[3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(held.factorize(wrong), Error);
  EXPECT_THROW(PlateSolver(g, kSection, std::vector<HeldUnknown>{{1000, 0}}), Error);
}

}  // namespace
}  // namespace flexmorph::fem
