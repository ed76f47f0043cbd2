// Shows that a hot plate whose far edge is welded to a cold body is correct: energies, derivatives
// and displacements against a dense plate whose edge is held exactly by multipliers and against
// another support; Taylor tests; the sign of the thermal contribution.

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <array>
#include <cmath>

#include "optim/mmc/cycles/design_verification.h"
#include "optim/mmc/loads/restrained_expansion.h"
#include "tests/optim/mmc_hot.h"
#include "tests/support/errors.h"
#include "tests/support/gradient_check.h"

namespace flexmorph::mmc::test {
namespace {

using ::flexmorph::testing::error_of;
using ::flexmorph::testing::mentions;

/// Relative error because springs, not a rigid constraint, hold the edge, see edge_stiffness().
constexpr double kGivesWay = 1e-3;

fem::EslSets few_loads(int nx, int ny) {
  const Grid g{0, -0.04, 0.3, 0.1, nx, ny};
  fem::EslSets loads{g, {}};
  std::mt19937 engine(5);
  std::normal_distribution<double> normal;
  const std::array<int, 5> roots = {2, 0, 3, 2, 2};
  const std::array<double, 5> root = {1e-3, 2e-3, 0, -2e-3, 0};
  const std::array<double, 5> end = {1e-3, 1e-3, 2e-3, 0, 0};
  for (size_t l = 0; l < roots.size(); ++l) {
    fem::EslSet set;
    set.weight = 0.5 + 0.2 * static_cast<double>(l);
    set.root_column = roots[l];
    set.held_stretch = root[l];
    set.held_end_stretch = end[l];
    set.thermal_stretch = l == 4 ? 0 : 2e-3;
    set.deformation.setZero(2 * g.n_nodes());
    set.acceleration.resize(2 * g.n_nodes());
    for (double& a : set.acceleration) a = 200 * normal(engine);
    set.forces.push_back({g.node(nx, 1), {3, -7}});
    loads.sets.push_back(set);
  }
  return loads;
}

/// Reference solution of one load: K w = F + Bᵀ n, w_c = -g (0, Y) at the root. At the far edge the
/// differences of v are -g_e dy, and the second differences of u are zero.
struct Rigid {
  VectorXd w, derivative;  // of wᵀ K w, see optim/README.md, Hot plates
  double compliance = 0;

  Rigid(const fem::EslSets& loads, size_t l, const VectorXd& stiffness, const VectorXd& mass) {
    const Grid& g = loads.grid;
    const fem::EslSet& set = loads.sets[l];
    const int n = 2 * g.n_nodes(), held = 2 * g.node(set.root_column + 1, 0);
    const int rows = 2 * g.ny - 1;  // constraint rows of the far edge
    MatrixXd K = MatrixXd::Zero(n + rows, n + rows);
    VectorXd F = VectorXd::Zero(n + rows), given = F;
    const auto k = fem::q4_stiffness(kSection, g.dx(), g.dy());
    const auto m = fem::q4_mass(kSection, g.dx(), g.dy());
    const auto entries = [&](int cell) {
      std::array<int, 8> at{};
      for (size_t a = 0; a < 4; ++a) {
        at[2 * a] = 2 * g.node(cell / g.ny + fem::kCornerI[a], cell % g.ny + fem::kCornerJ[a]);
        at[2 * a + 1] = at[2 * a] + 1;
      }
      return at;
    };
    for (int c = 0; c < g.n_cells(); ++c) {
      const auto at = entries(c);
      if (c >= g.cell(set.root_column, 0)) K(at, at) += stiffness(c) * k;
      for (int a = 0; a < 8; ++a)
        for (int b = a % 2; b < 8; b += 2)
          F(at[static_cast<size_t>(a)]) -=
              mass(c) * m(a / 2, b / 2) * set.acceleration(at[static_cast<size_t>(b)]);
    }
    for (const fem::NodalForce& f : set.forces) F.segment<2>(2 * f.node) += f.force;
    const MatrixXd cells = K.topLeftCorner(n, n);
    for (int j = 0; j < g.ny; ++j) {
      const int v = 2 * g.node(g.nx, j) + 1;
      K(n + j, v) = K(v, n + j) = -1;
      K(n + j, v + 2) = K(v + 2, n + j) = 1;
    }
    for (int j = 0; j + 1 < g.ny; ++j) {
      const int u = 2 * g.node(g.nx, j), row = n + g.ny + j;
      K(row, u) = K(u, row) = K(row, u + 4) = K(u + 4, row) = 1;
      K(row, u + 2) = K(u + 2, row) = -2;
    }
    VectorXd mu = F;
    for (int j = 0; j <= g.ny; ++j)
      given(2 * g.node(set.root_column, j) + 1) = -set.held_stretch * g.node_position(0, j).y();
    VectorXd rhs = F - K * given;
    rhs.segment(n, g.ny).setConstant(-set.held_end_stretch * g.dy());
    const int free = n + rows - held;
    const Eigen::PartialPivLU<MatrixXd> factor(K.bottomRightCorner(free, free));
    VectorXd all = given;
    all.tail(free) += factor.solve(rhs.tail(free));
    mu.tail(free) = VectorXd(factor.solve(VectorXd(mu.tail(free))));
    mu.head(held).setZero();
    w = all.head(n);
    compliance = w.dot(cells * w);
    derivative.setZero(g.n_cells());
    for (int c = g.cell(set.root_column, 0); c < g.n_cells(); ++c) {
      const auto at = entries(c);
      const VectorXd w_c = w(at), mu_c = mu(at), k_w = k * w_c;
      derivative(c) = w_c.dot(k_w) - 2 * mu_c.dot(k_w);
    }
  }
};

void expect_rigid(const fem::EslSets& loads, const VectorXd& k, const VectorXd& m, bool compress) {
  // F . u contains the round-off of u, which the stiff edge increases.
  expect_answers(loads, k, m, compress, {kGivesWay, 1e-7, kGivesWay, kGivesWay}, [&](size_t l) {
    const Rigid rigid(loads, l, k, m);
    return Found{rigid.compliance, rigid.derivative, rigid.w};
  });
}

TEST(HeldEnd, EnergiesAreThoseOfARigidEdge) {
  for (const int fine : {1, 4}) {
    const fem::EslSets loads = few_loads(9 * fine, 3 * fine);
    const VectorXd m = random_factors(loads.grid, 1e-1, 2);
    for (const double smallest : {1e-2, 1.0})
      for (const bool compress : {false, true})
        expect_rigid(loads, random_factors(loads.grid, smallest, 1), m, compress);
  }
}

/// Returns smooth loads on a grid that is `fine` times as fine as 60 x 20.
fem::EslSets smooth_loads(int fine) {
  fem::EslSets loads = few_loads(60 * fine, 20 * fine);
  const Grid& g = loads.grid;
  for (fem::EslSet& set : loads.sets) {
    set.root_column *= fine;
    set.forces.clear();
    for (int node = 0; node < g.n_nodes(); ++node)
      set.acceleration.segment<2>(2 * node) =
          -100 * g.node_position(node / (g.ny + 1), node % (g.ny + 1)) + Vec2(0, 5);
  }
  return loads;
}

// The triangles of the verification hold the far edge of a full plate as its cells do. The energies
// of cells are extrapolated to the limit of fine cells, because they converge slowly: there are
// corners where a held edge meets a free one.
TEST(HeldEnd, VerificationAgreesWithCells) {
  const fem::EslSets coarse = smooth_loads(1), fine = smooth_loads(2);
  BodyProblem problem = body_of(Design(kGrid, layout(), kScale), {tdf_settings()});
  const Grid& g = problem.grid = fine.grid;
  problem.solid = {corners_of({{g.x0, g.y0}, {g.x0 + g.width, g.y0 + g.height}})};
  ASSERT_EQ(reason_not_verifiable(problem), "");
  const verification::OutlineVerification verified =
      verify_design(problem, exported_regions(problem), loads_by_position(problem, fine));
  const auto cells = [](const fem::EslSets& loads) -> VectorXd {
    const VectorXd ones = VectorXd::Ones(loads.grid.n_cells());
    return ComplianceEvaluator(loads, kSection, {}, ones, ones).individual(ones, ones);
  };
  const double sharpened = std::pow(2, 2 * 0.758) - 1;
  const VectorXd limit = cells(fine) - (cells(coarse) - cells(fine)) / sharpened;
  for (Eigen::Index l = 0; l < limit.size(); ++l)
    EXPECT_NEAR(verified.compliances[static_cast<size_t>(l)], limit[l], 0.005 * limit[l]) << l;
}

// Held expansion is relieved where material is removed. f is linear in all of k except for the
// springs.
TEST(HeldEnd, TakingMaterialOffRelievesHeldHeat) {
  fem::EslSets loads = hot_plate(3, kStretch);
  for (fem::EslSet& set : loads.sets) {
    set.held_end_stretch = set.held_stretch;
    set.acceleration.setZero();
    set.forces.clear();
  }
  const VectorXd k = random_factors(kGrid, 1e-3, 4);
  ComplianceEvaluator held(loads, kSection, {}, {}, {});
  ComplianceEvaluator::Value value, free;
  held.evaluate(k, k, value);
  EXPECT_GE(value.d_stiffness.minCoeff(), 0);
  EXPECT_LT((value.d_stiffness - value.d_held).norm(), 1e-14 * value.d_held.norm());
  EXPECT_NEAR(value.d_stiffness.dot(k), value.f, kGivesWay * value.f);
  EXPECT_LT(value.d_stiffness.dot(k), value.f);
  // An additional constraint increases the energy.
  for (fem::EslSet& set : loads.sets) set.held_end_stretch = 0;
  ComplianceEvaluator(loads, kSection, {}, {}, {}).evaluate(k, k, free);
  EXPECT_GT(value.f, 1.05 * free.f);
}

// ------------------------------------------------------------ derivatives

fem::EslSets held_plate(int n) {
  fem::EslSets loads = hot_plate(n, kStretch);
  for (size_t l = 0; l < loads.sets.size(); ++l) {
    fem::EslSet& set = loads.sets[l];
    set.held_end_stretch = l == 2 ? 0.3 * set.thermal_stretch : set.thermal_stretch;
    if (l == 3) set.held_stretch = 0;
    for (int j = 0; j <= kGrid.ny; ++j) {
      const double y = kGrid.node_position(0, j).y();
      set.deformation(2 * kGrid.node(set.root_column, j) + 1) = -set.held_stretch * y;
      set.deformation.segment<2>(2 * kGrid.node(kGrid.nx, j)) =
          Vec2(1e-4 + 3e-3 * y, 1e-4 - set.held_end_stretch * y);
    }
  }
  return loads;
}

TEST(HeldEnd, RemaindersAreOfSecondOrder) {
  const fem::EslSets loads = held_plate(4);
  const VectorXd k0 = random_factors(kGrid, 1e-3, 21), m0 = random_factors(kGrid, 1e-2, 22);
  const VectorXd k = random_factors(kGrid, 1e-3, 23), m = random_factors(kGrid, 1e-2, 24);
  for (const LoadDefinition definition :
       {LoadDefinition::inertia, LoadDefinition::frozen, LoadDefinition::stiffness}) {
    ComplianceEvaluator compliance(loads, kSection, {definition}, k0, m0);
    ComplianceEvaluator::Value value;
    compliance.evaluate(k, m, value);
    // The derivative is taken along ln k and ln m.
    const VectorXd p = random_factors(kGrid, 0.1, 25), r = random_factors(kGrid, 0.1, 26);
    const double slope =
        value.d_stiffness.dot(k.cwiseProduct(p)) + value.d_mass.dot(m.cwiseProduct(r));
    const auto f = [&](const VectorXd& s) {
      ComplianceEvaluator::Value at;
      compliance.evaluate(k.cwiseProduct((s[0] * p).array().exp().matrix()),
                          m.cwiseProduct((s[0] * r).array().exp().matrix()), at);
      return at.f;
    };
    // Below steps of 3e-5 the remainders have the size of the round-off of f on some processors.
    const auto taylor = optim::taylor_test(f, VectorXd::Constant(1, slope), VectorXd::Zero(1),
                                           VectorXd::Ones(1), 3e-3, 2, 0);
    EXPECT_NEAR(taylor.order, 2, 0.05) << taylor.table();
  }
}

TEST(HeldEnd, DerivativesAgreeWithDifferences) {
  ComplianceEvaluator compliance(held_plate(4), kSection, {}, {}, {});
  const VectorXd k = random_factors(kGrid, 1e-2, 31), m = random_factors(kGrid, 1e-2, 32);
  ComplianceEvaluator::Value value, plus, minus;
  compliance.evaluate(k, m, value);
  for (const int c : {kGrid.cell(7, 3), kGrid.cell(30, 9), kGrid.cell(58, 0), kGrid.cell(59, 0),
                      kGrid.cell(59, 5), kGrid.cell(59, 9)}) {
    VectorXd other = k;
    const double step = 1e-3 * k(c);
    other(c) = k(c) + step;
    compliance.evaluate(other, m, plus);
    other(c) = k(c) - step;
    compliance.evaluate(other, m, minus);
    // Differences of f lose 1e-12 of f to round-off; their own error is of the order of the step
    // squared.
    EXPECT_NEAR((plus.f - minus.f) / (2 * step), value.d_stiffness(c),
                1e-5 * std::abs(value.d_stiffness(c)) + 1e-11 * value.f / step)
        << c;
  }
}

// ------------------------------------------------------------ loads

// Static analysis at the design of the motion must return the deformation of the motion.
TEST(HeldEnd, StiffnessLoadsReturnTheDeformation) {
  const fem::EslSets loads = held_plate(4);
  const VectorXd k = random_factors(kGrid, 1e-3, 10);
  ComplianceEvaluator compliance(loads, kSection, {LoadDefinition::stiffness}, k, k);
  for (int l = 0; l < 4; ++l) {
    const fem::EslSet& set = loads.sets[static_cast<size_t>(l)];
    const VectorXd u = whole(set.deformation, set, kGrid);
    EXPECT_LT((compliance.displacement(k, k, l) - u).norm(), kGivesWay * u.norm()) << l;
  }
}

// There is one right-hand side for each root column and each ratio of the held stretches, and none
// for loads without held expansion.
TEST(HeldEnd, LoadsOfOneKindShareTheirGrowth) {
  fem::EslSets loads = hot_plate(12, kStretch);
  const auto n = [&] {
    return ComplianceEvaluator(loads, kSection, {.compress = false}, {}, {}).n_right_hand_sides();
  };
  for (fem::EslSet& set : loads.sets) set.root_column /= 4;
  EXPECT_EQ(n(), 12 + 3);
  for (fem::EslSet& set : loads.sets) set.held_end_stretch = set.held_stretch;
  EXPECT_EQ(n(), 12 + 3);
  loads.sets[5].held_end_stretch = 0;
  EXPECT_EQ(n(), 12 + 4);
  for (fem::EslSet& set : loads.sets) set.held_stretch = 0;
  EXPECT_EQ(n(), 12 + 3);
}

TEST(HeldEnd, RefusesWhatItDoesNotHold) {
  const VectorXd ones = VectorXd::Ones(kGrid.n_cells());
  fem::EslSets loads = hot_plate(2, kStretch);
  loads.sets[1].held_end_stretch = kStretch;
  EXPECT_TRUE(mentions(error_of(Error::Kind::input,
                                [&] {
                                  ComplianceEvaluator(loads, kSection,
                                                      {LoadDefinition::frozen, Support::far_end},
                                                      ones, ones);
                                }),
                       "far edge"));
  loads.sets[1].held_end_stretch = std::nan("");
  const std::string text =
      error_of(Error::Kind::input, [&] { ComplianceEvaluator(loads, kSection, {}, {}, {}); });
  EXPECT_TRUE(mentions(text, "load 1") && mentions(text, "thermal stretch")) << text;
  for (const double bad : {-1.0, std::nan("")}) {
    const std::string stiff =
        error_of(Error::Kind::input, [&] { fem::StaticSolver(kGrid, kSection, 0, bad); });
    EXPECT_TRUE(mentions(stiff, "stiffness") && mentions(stiff, "edge")) << stiff;
  }
}

}  // namespace
}  // namespace flexmorph::mmc::test
