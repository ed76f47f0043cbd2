// Shows that the bilinear cell and the static analysis with one factorization for every root column
// agree with patch states, beam theory, and Eigen's factorization of the matrix that is cut at the
// clamp.

#include "fem/solve/static_solver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "fem/solve/factorization/supernodal_factor.h"
#include "tests/support/dense.h"
#include "tests/support/sections.h"

namespace flexmorph::fem {
namespace {

using Vector8 = Eigen::Matrix<double, 8, 1>;

/// Returns u = strain . x + translation + rotation at the corners of a dx x dy cell.
Vector8 linear_field(const Vec3& strain, const Vec3& rigid, double dx, double dy) {
  Vector8 u;
  for (std::size_t a = 0; a < 4; ++a) {
    const double x = kCornerI[a] * dx, y = kCornerJ[a] * dy;
    const auto k = static_cast<Eigen::Index>(2 * a);
    u(k) = strain(0) * x + strain(2) / 2 * y + rigid(0) - rigid(2) * y;
    u(k + 1) = strain(1) * y + strain(2) / 2 * x + rigid(1) + rigid(2) * x;
  }
  return u;
}

TEST(Q4, IsSymmetricAndRigidMotionsCostNothing) {
  const auto K = q4_stiffness(kThinSection, 0.3, 0.2);
  EXPECT_LT((K - K.transpose()).cwiseAbs().maxCoeff(), 1e-15 * K.cwiseAbs().maxCoeff());
  const Vector8 u = linear_field(Vec3::Zero(), {0.4, -1.1, 0.7}, 0.3, 0.2);
  EXPECT_LT((K * u).cwiseAbs().maxCoeff(), 1e-14 * K.cwiseAbs().maxCoeff());
  const VectorXd values = testing::eigenvalues(K);
  EXPECT_GT(values(3), 1e-3 * values(7));  // exactly three eigenvalues are zero
}

// The corner forces of a constant stress are half of the traction of each of the two edges.
TEST(Q4, ConstantStrainGivesTheTractionsOfItsStress) {
  const double dx = 0.3, dy = 0.2, nu = kThinSection.poisson_ratio;
  const Vec3 strain{1e-3, -2e-3, 3e-3};
  const double E = kThinSection.youngs_modulus / (1 - nu * nu);
  const double s_x = E * (strain(0) + nu * strain(1)), s_y = E * (strain(1) + nu * strain(0));
  const double s_xy = E * (1 - nu) / 2 * strain(2);
  const Vector8 f = q4_stiffness(kThinSection, dx, dy) * linear_field(strain, {1, 2, 3}, dx, dy);
  for (std::size_t a = 0; a < 4; ++a) {
    const double n_x = 2 * kCornerI[a] - 1, n_y = 2 * kCornerJ[a] - 1;
    const double h = kThinSection.thickness / 2;
    const auto k = static_cast<Eigen::Index>(2 * a);
    const double scale = E * 1e-3 * h * dx;
    EXPECT_NEAR(f(k), h * (s_x * n_x * dy + s_xy * n_y * dx), 1e-10 * scale);
    EXPECT_NEAR(f(k + 1), h * (s_xy * n_x * dy + s_y * n_y * dx), 1e-10 * scale);
  }
}

TEST(Q4, EnergyAndMassOfManyLoadsEqualTheMatrixProducts) {
  const double dx = 0.3, dy = 0.2;
  const auto K = q4_stiffness(kThinSection, dx, dy);
  const Eigen::Matrix4d M = q4_mass(kThinSection, dx, dy);
  EXPECT_NEAR(M.sum(), kThinSection.density * kThinSection.thickness * dx * dy, 1e-14);
  const int n = 21;
  std::srand(3);
  const MatrixXd x = MatrixXd::Random(n, 8), z = MatrixXd::Random(n, 8);
  const VectorXd w = VectorXd::Random(n);
  VectorXd energy(n), product(n);
  Q4Energy::Corners corners;
  Q4MassProduct::Corners a, b;
  for (std::size_t c = 0; c < 4; ++c) {
    const auto k = static_cast<Eigen::Index>(2 * c);
    corners.u[c] = a[c] = &x(0, k);
    corners.v[c] = &x(0, k + 1);
    b[c] = &z(0, k);
  }
  Q4Energy(kThinSection, dx, dy).weighted(corners, w.data(), n, energy.data());
  Q4MassProduct(kThinSection, dx, dy).multiply(a, b, n, product.data());
  for (int l = 0; l < n; ++l) {
    const Vector8 u = x.row(l).transpose();
    EXPECT_NEAR(energy(l), w(l) * u.dot(K * u), 1e-13 * K.cwiseAbs().maxCoeff());
    Eigen::Vector4d p, q;
    for (int c = 0; c < 4; ++c) {
      p(c) = x(l, 2 * c);
      q(c) = z(l, 2 * c);
    }
    EXPECT_NEAR(product(l), p.dot(M * q), 1e-14 * M.sum());
  }
}

/// Returns the stiffness of all nodes behind column `root`, assembled cell by cell, with unknowns
/// numbered from the root. Only the cell matrix is shared with the solver.
Eigen::SparseMatrix<double> cut_stiffness(const Grid& g, const VectorXd& factor, int root) {
  const auto K = q4_stiffness(kThinSection, g.dx(), g.dy());
  std::vector<Eigen::Triplet<double>> entries;
  const auto dof = [&](int i, int j) {
    return i <= root ? -1 : 2 * ((i - root - 1) * (g.ny + 1) + j);
  };
  for (int i = root; i < g.nx; ++i) {
    for (int j = 0; j < g.ny; ++j) {
      for (int a = 0; a < 8; ++a) {
        for (int b = 0; b < 8; ++b) {
          const int r = dof(i + kCornerI[a / 2], j + kCornerJ[a / 2]);
          const int c = dof(i + kCornerI[b / 2], j + kCornerJ[b / 2]);
          if (r < 0 || c < 0) continue;
          entries.emplace_back(r + a % 2, c + b % 2, factor(g.cell(i, j)) * K(a, b));
        }
      }
    }
  }
  const int n = 2 * (g.nx - root) * (g.ny + 1);
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

/// Returns the solution of one load clamped at `root` by Eigen, in the numbering of the solver.
VectorXd refactored(const StaticSolver& solver, const VectorXd& factor, const VectorXd& load,
                    int root) {
  const Grid& g = solver.grid();
  const Eigen::SparseMatrix<double> K = cut_stiffness(g, factor, root);
  VectorXd f(K.rows()), all = VectorXd::Zero(solver.n_unknowns());
  const auto dof = [&](int i, int j) { return 2 * ((i - root - 1) * (g.ny + 1) + j); };
  for (int i = root + 1; i <= g.nx; ++i) {
    for (int j = 0; j <= g.ny; ++j)
      f.segment<2>(dof(i, j)) = load.segment<2>(solver.row(g.node(i, j), 0));
  }
  VectorXd u = testing::solve(K, f);
  // one refinement, so that the reference does not limit the comparison
  u += testing::solve(K, f - K * u);
  for (int i = root + 1; i <= g.nx; ++i) {
    for (int j = 0; j <= g.ny; ++j)
      all.segment<2>(solver.row(g.node(i, j), 0)) = u.segment<2>(dof(i, j));
  }
  return all;
}

VectorXd random_factors(const Grid& g, double smallest, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(std::log(smallest), 0);
  VectorXd factor(g.n_cells());
  for (double& f : factor) f = std::exp(uniform(engine));
  return factor;
}

const Grid kGrid{0, 0, 1.2, 0.35, 24, 7};

std::vector<std::vector<int>> root_column_orders() {
  return {{20, 17, 17, 11, 5, 4, 2}, {2, 3, 8, 13, 13, 21, 24}, {9, 2, 23, 2, 16, 4, 7}};
}

// The loads are clamped at different columns, in falling, rising and mixed order.
TEST(StaticSolver, EveryRootColumnEqualsRefactoring) {
  StaticSolver solver(kGrid, kThinSection, 2);
  const VectorXd factor = random_factors(kGrid, 1e-3, 1);
  solver.factorize(factor);
  for (const std::vector<int>& roots : root_column_orders()) {
    std::srand(5);
    const auto n = static_cast<Eigen::Index>(roots.size());
    const MatrixXd loads = MatrixXd::Random(n, solver.n_unknowns());
    MatrixXd u = loads;
    solver.solve(u, roots);
    for (Eigen::Index l = 0; l < n; ++l) {
      const int root = roots[static_cast<std::size_t>(l)];
      if (root == kGrid.nx) {
        EXPECT_EQ(u.row(l).cwiseAbs().maxCoeff(), 0);
        continue;
      }
      const VectorXd expected = refactored(solver, factor, loads.row(l).transpose(), root);
      // the condition number is about 1e7; 1e-10 includes a factor of ten
      EXPECT_LT((u.row(l).transpose() - expected).norm(), 1e-10 * expected.norm()) << root;
      for (int j = 0; j <= kGrid.ny; ++j) {
        if (solver.row(kGrid.node(root, j), 0) >= 0) {
          EXPECT_EQ(u(l, solver.row(kGrid.node(root, j), 0)), 0);
        }
      }
    }
  }
}

TEST(StaticSolver, MixedLoadsEqualTheirCombination) {
  StaticSolver solver(kGrid, kThinSection, 2);
  solver.factorize(random_factors(kGrid, 1e-3, 2));
  for (const std::vector<int>& roots : root_column_orders()) {
    std::srand(6);
    const MatrixXd mix = MatrixXd::Random(static_cast<Eigen::Index>(roots.size()), 3);
    MatrixXd basis = MatrixXd::Random(3, solver.n_unknowns());
    MatrixXd expected = mix * basis, u;
    solver.solve(expected, roots);
    solver.solve_mixed(mix, basis, roots, u);
    for (Eigen::Index l = 0; l < u.rows(); ++l) {
      EXPECT_LE((u.row(l) - expected.row(l)).norm(), 1e-10 * expected.row(l).norm());
    }
  }
}

TEST(StaticSolver, ForcesAndEnergiesBelongToTheSameMatrix) {
  StaticSolver solver(kGrid, kThinSection, 2);
  const VectorXd factor = random_factors(kGrid, 1e-3, 3);
  solver.factorize(factor);
  const std::vector<int> roots = {9, 2, 23, 2, 16, 4, 7};
  std::srand(7);
  MatrixXd u = MatrixXd::Random(7, solver.n_unknowns()), forces;
  solver.solve(u, roots);  // zero behind the clamp
  solver.apply(factor, u, forces);
  const Eigen::SparseMatrix<double> K = cut_stiffness(kGrid, factor, 2);
  for (Eigen::Index l = 0; l < 7; ++l) {
    VectorXd x(K.rows()), f(K.rows());
    for (int i = 3, k = 0; i <= kGrid.nx; ++i) {
      for (int j = 0; j <= kGrid.ny; ++j, k += 2) {
        x.segment<2>(k) = u.row(l).segment<2>(solver.row(kGrid.node(i, j), 0)).transpose();
        f.segment<2>(k) = forces.row(l).segment<2>(solver.row(kGrid.node(i, j), 0)).transpose();
      }
    }
    EXPECT_LT((K * x - f).norm(), 1e-13 * K.norm() * x.norm());
  }
  const VectorXd w = VectorXd::LinSpaced(7, 0.1, 0.9);
  VectorXd energies, energies_cut;
  solver.cell_energies(u, w, energies);
  solver.cell_energies(u, w, energies_cut, roots);
  const double expected = w.dot(u.cwiseProduct(forces).rowwise().sum());
  EXPECT_NEAR(factor.dot(energies), expected, 1e-9 * expected);
  EXPECT_LT((energies - energies_cut).cwiseAbs().maxCoeff(), 1e-13 * energies.maxCoeff());
  EXPECT_EQ(energies.head(2 * kGrid.ny).cwiseAbs().maxCoeff(), 0);  // inside the hub
}

TEST(StaticSolver, SquaresOfTheForwardSubstitutionAreCompliances) {
  StaticSolver solver(kGrid, kThinSection);
  solver.factorize(random_factors(kGrid, 1e-2, 4));
  std::srand(8);
  const MatrixXd F = MatrixXd::Random(3, solver.n_unknowns());
  MatrixXd y = F, u = F;
  solver.forward(y);
  solver.solve(u, std::vector<int>{0, 0, 0});
  for (int l = 0; l < 3; ++l) {
    EXPECT_NEAR(y.row(l).squaredNorm(), F.row(l).dot(u.row(l)), 1e-10 * y.row(l).squaredNorm());
  }
}

/// Returns the mean tip deflection under a uniform shear traction with resultant 1 N at the free
/// end.
double tip_deflection(int nx, int ny) {
  const Grid g{0, 0, 1.0, 0.1, nx, ny};
  StaticSolver solver(g, kThinSection);
  solver.factorize(VectorXd::Ones(g.n_cells()));
  MatrixXd u = MatrixXd::Zero(1, solver.n_unknowns());
  VectorXd share = VectorXd::Constant(ny + 1, 1.0 / ny);
  share(0) = share(ny) = 0.5 / ny;
  for (int j = 0; j <= ny; ++j) u(0, solver.row(g.node(nx, j), 1)) = share(j);
  solver.solve(u, std::vector<int>{0});
  double deflection = 0;
  for (int j = 0; j <= ny; ++j) deflection += share(j) * u(0, solver.row(g.node(nx, j), 1));
  return deflection;
}

TEST(StaticSolver, CantileverConvergesToTimoshenko) {
  const double I = 0.01 * 1e-3 / 12, A = 0.01 * 0.1, E = 1e8, G = E / 2.6;
  const double beam = 1 / (3 * E * I) + 1 / (5.0 / 6 * G * A);
  const double coarse = tip_deflection(40, 4), middle = tip_deflection(80, 8),
               fine = tip_deflection(160, 16);
  // The clamp prevents the lateral contraction of the root, which the beam does not contain: 0.2 %.
  EXPECT_NEAR(fine, beam, 0.01 * beam);
  const double limit = fine + (fine - middle) / 3;
  EXPECT_NEAR(limit, beam, 0.005 * beam);
  EXPECT_NEAR(std::log2((middle - coarse) / (fine - middle)), 2.0, 0.15);
}

TEST(StaticSolver, RefusesWhatItCannotFactor) {
  StaticSolver solver(kGrid, kThinSection);
  VectorXd factor = VectorXd::Ones(kGrid.n_cells());
  const auto kind_of = [&](const VectorXd& f) {
    try {
      solver.factorize(f);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), Error::Kind::numerical) << error.what();
      return std::string(error.what());
    }
    return std::string();
  };
  factor(kGrid.cell(12, 3)) = -5;
  for (const char* part : {"positive definite", "column 1"})
    EXPECT_NE(kind_of(factor).find(part), std::string::npos) << kind_of(factor);
  factor(kGrid.cell(12, 3)) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(kind_of(factor).find(" finite"), std::string::npos) << kind_of(factor);
  factor.setOnes();
  factor.segment(kGrid.cell(10, 0), kGrid.ny).setZero();  // a gap: the free side is not held
  EXPECT_FALSE(kind_of(factor).empty());
  EXPECT_FALSE(kind_of(VectorXd::Ones(3)).empty());
  factor.setConstant(1e308);
  EXPECT_FALSE(kind_of(factor).empty());
  factor.setOnes();
  EXPECT_TRUE(kind_of(factor).empty());  // the solver is still usable afterwards

  MatrixXd loads = MatrixXd::Ones(1, solver.n_unknowns());
  EXPECT_THROW(solver.solve(loads, std::vector<int>{25}), Error);
  EXPECT_THROW(solver.solve(loads, std::vector<int>{-1}), Error);
  EXPECT_THROW(solver.solve(loads, std::vector<int>{1, 2}), Error);
  EXPECT_THROW(StaticSolver(kGrid, kThinSection, 24), Error);
}

// The rows of supernodes are not a range, which does not occur in plates numbered column by column.
TEST(SupernodalFactor, ScatteredRowsAndLeadingBlocks) {
  const int n = 40;
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n, n);
  for (int c = 0; c < n; ++c) {
    K(c, c) = 4 + 0.1 * c;
    for (int r : {c + 1, c + 7, (c * c) % n, n - 1}) {
      if (r > c && r < n) K(r, c) = K(c, r) = -0.3 - 0.01 * r;
    }
  }
  K += 3 * Eigen::MatrixXd::Identity(n, n);
  std::vector<int> starts = {0}, rows;
  for (int c = 0; c < n; ++c) {
    for (int r = c; r < n; ++r) {
      if (K(r, c) != 0) rows.push_back(r);
    }
    starts.push_back(static_cast<int>(rows.size()));
  }
  SupernodalFactor factor(starts, rows);
  for (std::size_t c = 0, k = 0; c < static_cast<std::size_t>(n); ++c) {
    for (; k < static_cast<std::size_t>(starts[c + 1]); ++k) {
      factor.values()[k] = K(rows[k], static_cast<Eigen::Index>(c));
    }
  }
  ASSERT_EQ(factor.factorize(), -1);
  const std::vector<int> active = {40, 33, 33, 17, 4, 0};
  const MatrixXd loads = MatrixXd::Random(6, n);
  MatrixXd x = loads;
  factor.forward(x, active);
  factor.backward(x, active);
  for (int l = 0; l < 6; ++l) {
    const int a = active[static_cast<std::size_t>(l)];
    VectorXd expected = VectorXd::Zero(n);
    if (a > 0) {
      const VectorXd f = loads.row(l).head(a).transpose();
      expected.head(a) = testing::solve(MatrixXd(K.topLeftCorner(a, a)), f);
    }
    EXPECT_LT((x.row(l).transpose() - expected).norm(), 1e-13 * (1 + expected.norm())) << l;
  }
}

// For loads next to the clamp only, the shortened substitution must equal the whole one in any
// order of clamps.
TEST(StaticSolver, LoadsAtTheClampSkipWhatIsZero) {
  const Grid g{0, 0, 0.4, 0.1, 16, 4};
  StaticSolver solver(g, kThinSection, 1);
  std::mt19937 engine(9);
  std::uniform_real_distribution<double> uniform(0.01, 1);
  VectorXd factor(g.n_cells());
  for (double& f : factor) f = uniform(engine);
  solver.factorize(factor);
  for (std::vector<int> roots : {std::vector{1, 2, 2, 5, 9, 15}, {15, 7, 3, 3, 1}, {4, 12, 1, 9}}) {
    MatrixXd loads = MatrixXd::Zero(static_cast<Eigen::Index>(roots.size()), solver.n_unknowns());
    for (Eigen::Index l = 0; l < loads.rows(); ++l)
      for (int k = 0; k < 2 * (g.ny + 1); ++k)
        loads(l, solver.row(g.node(roots[static_cast<std::size_t>(l)] + 1, 0), 0) + k) =
            uniform(engine);
    MatrixXd all = loads;
    solver.solve(all, roots);
    solver.solve_at_clamp(loads, roots);
    EXPECT_LT((loads - all).norm(), 1e-12 * all.norm());
  }
}

}  // namespace
}  // namespace flexmorph::fem
