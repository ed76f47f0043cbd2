// Shows that heat in the static analysis of designs is correct: energies of hot plates against a
// dense solution, closed forms and other supports; the sign of the thermal contribution; loads of
// plates that expand freely equal those of cold plates bit for bit.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "tests/optim/mmc_hot.h"
#include "tests/support/errors.h"

namespace flexmorph::mmc::test {
namespace {

using ::flexmorph::testing::error_of;
using ::flexmorph::testing::mentions;

// ------------------------------------------------------------ one dense plate

/// wᵀ K w and its derivative by the formula of optim/README.md, Hot plates, with all unknowns in
/// one dense matrix.
struct Dense {
  Grid g;
  fem::PlaneSection section = kSection;
  VectorXd stiffness;
  std::vector<char> exists;       // for every cell
  std::vector<int> held, free{};  // entries 2 node + c
  VectorXd F, w_c;                // for all entries
  VectorXd w, mu;                 // solution

  template <class Use>
  void each_cell(const Use& use) const {
    const auto k = fem::q4_stiffness(section, g.dx(), g.dy());
    for (int c = 0; c < g.n_cells(); ++c) {
      if (!exists[static_cast<size_t>(c)]) continue;
      std::array<int, 8> at{};
      for (size_t a = 0; a < 4; ++a) {
        at[2 * a] = 2 * g.node(c / g.ny + fem::kCornerI[a], c % g.ny + fem::kCornerJ[a]);
        at[2 * a + 1] = at[2 * a] + 1;
      }
      use(c, at, k);
    }
  }
  void solve() {
    MatrixXd K = MatrixXd::Zero(F.size(), F.size());
    each_cell(
        [&](int c, const std::array<int, 8>& at, const auto& k) { K(at, at) += stiffness(c) * k; });
    const Eigen::LLT<MatrixXd> factor(K(free, free));
    w = w_c;
    w(free) = VectorXd(factor.solve(VectorXd(F(free) - K(free, held) * w_c(held))));
    mu = VectorXd::Zero(F.size());
    mu(free) = VectorXd(factor.solve(VectorXd(F(free))));
    compliance = w.dot(K * w);
  }
  /// Returns 2 (wᵀ K_b w / 2 - μᵀ K_b w) for all cells.
  VectorXd derivative() const {
    VectorXd out = VectorXd::Zero(g.n_cells());
    each_cell([&](int c, const std::array<int, 8>& at, const auto& k) {
      const VectorXd w_cell = w(at), mu_cell = mu(at), k_w = k * w_cell;
      out(c) = w_cell.dot(k_w) - 2 * mu_cell.dot(k_w);
    });
    return out;
  }
  double compliance = 0;
};

Dense dense(const Grid& g, const VectorXd& stiffness) {
  Dense out;
  out.g = g;
  out.stiffness = stiffness;
  out.exists.assign(static_cast<size_t>(g.n_cells()), 1);
  out.F = out.w_c = VectorXd::Zero(2 * g.n_nodes());
  return out;
}

/// Returns the reference solution of one load with a moving root: the plate in front of the clamp.
Dense dense_load(const fem::EslSets& loads, size_t l, const VectorXd& stiffness,
                 const VectorXd& mass) {
  const Grid& g = loads.grid;
  const fem::EslSet& set = loads.sets[l];
  Dense out = dense(g, stiffness);
  for (int c = 0; c < g.cell(set.root_column, 0); ++c) out.exists[static_cast<size_t>(c)] = 0;
  for (int n = g.node(set.root_column, 0); n < g.n_nodes(); ++n)
    for (int c = 0; c < 2; ++c)
      (n < g.node(set.root_column + 1, 0) ? out.held : out.free).push_back(2 * n + c);
  for (int j = 0; j <= g.ny; ++j) {
    const int n = g.node(set.root_column, j);
    out.w_c(2 * n + 1) = -set.held_stretch * g.node_position(set.root_column, j).y();
  }
  const Eigen::Matrix4d m = fem::q4_mass(kSection, g.dx(), g.dy());
  for (int cell = 0; cell < g.n_cells(); ++cell)
    for (size_t a = 0; a < 4; ++a)
      for (size_t b = 0; b < 4; ++b) {
        const auto node = [&](size_t k) {
          return g.node(cell / g.ny + fem::kCornerI[k], cell % g.ny + fem::kCornerJ[k]);
        };
        out.F.segment<2>(2 * node(a)) -=
            mass(cell) * m(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) *
            set.acceleration.segment<2>(2 * node(b));
      }
  for (const fem::NodalForce& f : set.forces) out.F.segment<2>(2 * f.node) += f.force;
  out.solve();
  return out;
}

/// Returns loads on a grid that is small enough for dense matrices, with roots in any order.
fem::EslSets few_hot_loads() {
  const Grid g{0, -0.05, 0.3, 0.1, 9, 3};
  fem::EslSets loads{g, {}};
  std::mt19937 engine(5);
  std::normal_distribution<double> normal;
  const std::array<int, 4> roots = {2, 0, 3, 2};
  const std::array<double, 4> held = {1e-3, 2e-3, 0, -2e-3};
  for (size_t l = 0; l < 4; ++l) {
    fem::EslSet set;
    set.weight = 0.5 + 0.2 * static_cast<double>(l);
    set.root_column = roots[l];
    set.held_stretch = held[l];
    set.thermal_stretch = 2e-3;
    set.deformation.setZero(2 * g.n_nodes());
    set.acceleration.resize(2 * g.n_nodes());
    for (double& a : set.acceleration) a = 60 * normal(engine);
    set.forces.push_back({g.node(9, 1), {3, -7}});
    loads.sets.push_back(set);
  }
  return loads;
}

TEST(HotCompliance, EnergiesAreThoseOfTheDenseEquations) {
  const fem::EslSets loads = few_hot_loads();
  const VectorXd k = random_factors(loads.grid, 1e-2, 1), m = random_factors(loads.grid, 1e-1, 2);
  for (const bool compress : {false, true})
    expect_answers(loads, k, m, compress, {1e-10, 1e-10, 1e-9, 1e-8}, [&](size_t l) {
      const Dense dense = dense_load(loads, l, k, m);
      return Found{dense.compliance, dense.derivative(), dense.w};
    });
}

// Several held nodes, some in one direction only, and a domain with a hole.
TEST(HotStatics, EnergiesAreThoseOfTheDenseEquations) {
  const Grid g{0.2, 0.1, 0.3, 0.1, 9, 3};
  std::vector<signed char> outside(static_cast<size_t>(g.n_cells()), 0);
  outside[static_cast<size_t>(g.cell(4, 1))] = 1;
  outside[static_cast<size_t>(g.cell(8, 2))] = 1;
  std::vector<fem::HeldUnknown> held = {{g.node(0, 0), 0}, {g.node(0, 0), 1}, {g.node(0, 3), 0},
                                        {g.node(9, 0), 1}, {g.node(9, 1), 0}, {g.node(5, 3), 1}};
  std::vector<LoadCase> cases = {{"hot", 1.0, {{g.node(9, 2), {4, 9}}}, 1e-3},
                                 {"cold", 0.5, {{g.node(3, 3), {-1, 20}}}, 0},
                                 {"heat alone", 2.0, {}, -2e-3}};
  const VectorXd k = random_factors(g, 1e-2, 3);
  held.push_back({g.node(9, 3), 0});  // touches no cell of the domain
  ComplianceEvaluator plate({g, kSection, outside}, held, cases, true);
  held.pop_back();
  ComplianceEvaluator::Value value;
  ComplianceEvaluator::Each each;
  plate.evaluate(k, k, value);
  plate.evaluate_each(k, k, each);
  double sum = 0;
  VectorXd d_sum = VectorXd::Zero(k.size());
  for (int l = 0; l < 3; ++l) {
    const LoadCase& load = cases[static_cast<size_t>(l)];
    Dense expected = dense(g, k);
    for (size_t c = 0; c < outside.size(); ++c) expected.exists[c] = !outside[c];
    for (const fem::NodalForce& f : load.forces) expected.F.segment<2>(2 * f.node) += f.force;
    VectorXd e(expected.F.size());
    for (int n = 0; n < g.n_nodes(); ++n) {
      e.segment<2>(2 * n) = load.thermal_stretch * g.node_position(n / 4, n % 4);
      for (int c = 0; c < 2; ++c) {
        const bool is_held = std::any_of(held.begin(), held.end(), [&](const auto& h) {
          return h.node == n && h.component == c;
        });
        if (n != g.node(9, 3)) (is_held ? expected.held : expected.free).push_back(2 * n + c);
        if (is_held) expected.w_c(2 * n + c) = -e(2 * n + c);
      }
    }
    e.segment<2>(2 * g.node(9, 3)).setZero();
    expected.solve();
    const VectorXd d = expected.derivative();
    sum += load.weight * expected.compliance;
    d_sum += load.weight * d;
    const int at = plate.position(l);
    EXPECT_NEAR(each.f(at), expected.compliance, 1e-10 * expected.compliance);
    EXPECT_LT((each.d_stiffness.row(at).transpose() - d).norm(), 1e-10 * d.norm());
    const VectorXd u = expected.w + e;
    EXPECT_LT((plate.displacement(k, k, at) - u).norm(), 1e-10 * u.norm());
  }
  EXPECT_NEAR(value.f, sum, 1e-9 * sum);
  EXPECT_LT((value.d_stiffness - d_sum).norm(), 1e-8 * d_sum.norm());
  EXPECT_LT((plate.individual(k, k) - each.f).norm(), 1e-11 * each.f.norm());
}

// ------------------------------------------------------------ closed forms

// All expansion is held: ε = -a in both directions. Reference: U = E/(1 - ν) a² A c.
TEST(HotStatics, APlateHeldAllAroundHasTheBiaxialEnergy) {
  std::vector<fem::HeldUnknown> held = edge(0, {0, 1}) + edge(kGrid.nx, {0, 1});
  for (int i = 1; i < kGrid.nx; ++i)
    for (const int j : {0, kGrid.ny})
      for (const int c : {0, 1}) held.push_back({kGrid.node(i, j), c});
  const double a = 2e-3;
  const std::vector<LoadCase> heat = {{"heat", 1, {}, a}};
  ComplianceEvaluator plate({kGrid, kSection, {}}, held, heat, true);
  const VectorXd ones = VectorXd::Ones(kGrid.n_cells());
  ComplianceEvaluator::Value value;
  plate.evaluate(ones, ones, value);
  const double volume = kGrid.width * kGrid.height * kSection.thickness;
  const double energy = kSection.youngs_modulus / (1 - kSection.poisson_ratio) * a * a * volume;
  EXPECT_NEAR(value.f, 2 * energy, 1e-11 * energy);
  // Every cell has an equal share of the energy.
  EXPECT_LT((value.d_stiffness.array() - 2 * energy / kGrid.n_cells()).abs().maxCoeff(),
            1e-9 * energy / kGrid.n_cells());
  EXPECT_LT(plate.displacement(ones, ones, 0).norm(), 1e-14);
}

/// A bar of columns with stiffnesses k_i between two walls that permit lateral expansion.
/// Reference: one force N = a L / Σ dx/(E A k_i) acts in all columns, U = N a L / 2.
struct Bar {
  ComplianceEvaluator plate;
  double a, EA;

  explicit Bar(double stretch)
      : plate({kGrid, section(), {}},
              edge(0, {0}) + edge(kGrid.nx, {0}) + std::vector{fem::HeldUnknown{0, 1}},
              std::vector{LoadCase{"heat", 1, {}, stretch}}, true),
        a(stretch),
        EA(kSection.youngs_modulus * kSection.thickness * kGrid.height) {}
  static fem::PlaneSection section() {  // no lateral strain couples the columns
    fem::PlaneSection s = kSection;
    s.poisson_ratio = 0;
    return s;
  }
  double energy(const VectorXd& columns) const {
    return 0.5 * a * a * kGrid.width * kGrid.width /
           (kGrid.dx() * columns.cwiseInverse().sum() / EA);
  }
  static VectorXd cells(const VectorXd& columns) {
    VectorXd out(kGrid.n_cells());
    for (int c = 0; c < kGrid.n_cells(); ++c) out(c) = columns(c / kGrid.ny);
    return out;
  }
};

TEST(HotStatics, ABarBetweenWallsHasTheEnergyOfItsForce) {
  Bar bar(-1e-3);
  VectorXd columns(kGrid.nx);
  for (int i = 0; i < kGrid.nx; ++i) columns(i) = 0.3 + 0.7 * std::pow(std::sin(0.2 * i), 2);
  const VectorXd k = Bar::cells(columns);
  ComplianceEvaluator::Value value;
  bar.plate.evaluate(k, k, value);
  const double energy = bar.energy(columns);
  EXPECT_NEAR(value.f, 2 * energy, 1e-10 * energy);
  // dU/dk_i of the closed form is U (1/k_i²) / Σ 1/k.
  for (const int i : {0, 7, 31, 59}) {
    const double expected = 2 * energy / (columns(i) * columns(i) * columns.cwiseInverse().sum());
    EXPECT_NEAR(value.d_stiffness.segment(kGrid.cell(i, 0), kGrid.ny).sum(), expected,
                1e-9 * expected);
  }
}

// Held expansion is relieved where material is removed: every derivative is positive, and the
// energy decreases with the stiffness of a column as the closed form says. The formula for dead
// loads, -wᵀ K_b w, would have the opposite sign.
TEST(HotStatics, TakingMaterialOffAHeldPlateRelievesIt) {
  Bar bar(2e-3);
  VectorXd columns = VectorXd::Ones(kGrid.nx);
  ComplianceEvaluator::Value full, weak;
  bar.plate.evaluate(Bar::cells(columns), Bar::cells(columns), full);
  EXPECT_GT(full.d_stiffness.minCoeff(), 0);
  columns(20) = 0.5;
  bar.plate.evaluate(Bar::cells(columns), Bar::cells(columns), weak);
  EXPECT_NEAR(weak.f / full.f, 60.0 / 61.0, 1e-10);
  const VectorXd k = random_factors(kGrid, 1e-3, 4);
  ComplianceEvaluator::Value value;
  fem::EslSets loads = hot_plate(3, kStretch);
  for (fem::EslSet& set : loads.sets) {
    set.acceleration.setZero();
    set.forces.clear();
  }
  ComplianceEvaluator root(loads, kSection, {}, {}, {});
  root.evaluate(k, k, value);
  EXPECT_GT(value.f, 0);
  EXPECT_GE(value.d_stiffness.minCoeff(), 0);
  EXPECT_NEAR(value.d_stiffness.dot(k), value.f, 1e-11 * value.f);  // f is linear in all of k
}

// If the supports permit the expansion, the compliance equals that of a cold plate bit for bit, and
// the plate expands about the held point.
TEST(HotStatics, FreeGrowthCostsNothing) {
  const int corner = kGrid.node(0, 0), slide = kGrid.node(0, kGrid.ny), tip = kGrid.node(60, 5);
  const std::vector<fem::HeldUnknown> held = {{corner, 0}, {corner, 1}, {slide, 0}};
  const auto cases = [&](double a) { return std::vector{LoadCase{"pull", 1, {{tip, {5, 1}}}, a}}; };
  ComplianceEvaluator hot({kGrid, kSection, {}}, held, cases(1e-2), true),
      cold({kGrid, kSection, {}}, held, cases(0), true);
  const VectorXd k = random_factors(kGrid, 1e-3, 6);
  ComplianceEvaluator::Value a, b;
  hot.evaluate(k, k, a);
  cold.evaluate(k, k, b);
  EXPECT_EQ(a.f, b.f);
  EXPECT_EQ(a.d_stiffness, b.d_stiffness);
  EXPECT_EQ(hot.n_right_hand_sides(), 1);
  const VectorXd growth = hot.displacement(k, k, 0) - cold.displacement(k, k, 0);
  for (int n = 0; n < kGrid.n_nodes(); ++n) {
    const Vec2 at = kGrid.node_position(n / 11, n % 11) - kGrid.node_position(0, 0);
    EXPECT_LT((growth.segment<2>(2 * n) - 1e-2 * at).norm(), 1e-12);
  }
  const std::string text = error_of(Error::Kind::input, [&] {
    ComplianceEvaluator({kGrid, kSection, {}}, held, std::vector{LoadCase{"sun", 1, {}, 1e-3}},
                        true);
  });
  EXPECT_TRUE(mentions(text, "'sun'") && mentions(text, "thermal expansion")) << text;
  for (const double bad : {-1.0, std::nan("")}) {
    const auto make = [&] { ComplianceEvaluator({kGrid, kSection, {}}, held, cases(bad), true); };
    EXPECT_TRUE(mentions(error_of(Error::Kind::input, make), "thermal stretch"));
  }
}

// ------------------------------------------------------------ moving roots

// The clamp of one solver must agree with the supports of the other.
TEST(HotCompliance, AClampedEdgeIsThatOfAPlateAtRest) {
  const double a = 3e-3;
  fem::EslSets loads = turning_plate(1);
  loads.sets[0].thermal_stretch = loads.sets[0].held_stretch = a;
  loads.sets[0].weight = 1;
  loads.sets[0].acceleration.setZero();
  loads.sets[0].forces = {{kGrid.node(60, 5), {1, 4}}};
  ComplianceEvaluator moving(loads, kSection, {}, {}, {});
  ComplianceEvaluator rest({kGrid, kSection, {}}, edge(0, {0, 1}),
                           std::vector{LoadCase{"hot", 1, loads.sets[0].forces, a}}, true);
  const VectorXd k = random_factors(kGrid, 1e-3, 7);
  ComplianceEvaluator::Value one, other;
  moving.evaluate(k, k, one);
  rest.evaluate(k, k, other);
  EXPECT_NEAR(one.f, other.f, 1e-9 * other.f);
  EXPECT_LT((one.d_stiffness - other.d_stiffness).norm(), 1e-9 * other.d_stiffness.norm());
  const VectorXd u = moving.displacement(k, k, 0);
  EXPECT_LT((u - rest.displacement(k, k, 0)).norm(), 1e-9 * u.norm());
  EXPECT_LT(u.head(2 * 11).norm(), 1e-15);
}

TEST(HotCompliance, FreeGrowthIsColdBitForBit) {
  const VectorXd k = random_factors(kGrid, 1e-3, 8), m = random_factors(kGrid, 1e-2, 9);
  for (const LoadDefinition definition : {LoadDefinition::inertia, LoadDefinition::frozen}) {
    ComplianceEvaluator hot(hot_plate(4, kStretch, true), kSection, {definition}, k, m),
        cold(hot_plate(4, 0), kSection, {definition}, k, m);
    ComplianceEvaluator::Value a, b;
    hot.evaluate(k, m, a);
    cold.evaluate(k, m, b);
    EXPECT_EQ(a.f, b.f);
    EXPECT_EQ(a.d_stiffness, b.d_stiffness);
    EXPECT_EQ(a.d_mass, b.d_mass);
    EXPECT_EQ(hot.n_right_hand_sides(), cold.n_right_hand_sides());
  }
}

// Every held root line adds one right-hand side, however many loads it has.
TEST(HotCompliance, LoadsOfOneRootColumnShareItsGrowth) {
  fem::EslSets loads = hot_plate(12, kStretch);
  for (fem::EslSet& set : loads.sets) set.root_column /= 4;
  fem::EslSets cold = loads;
  for (fem::EslSet& set : cold.sets) set.thermal_stretch = set.held_stretch = 0;
  const ComplianceEvaluator hot(loads, kSection, {}, {}, {}), without(cold, kSection, {}, {}, {});
  EXPECT_EQ(hot.n_right_hand_sides(), without.n_right_hand_sides() + 3);
}

// Static analysis at the design of the motion must return its elastic deformation.
TEST(HotCompliance, StiffnessLoadsReturnTheDeformation) {
  fem::EslSets loads = hot_plate(3, kStretch);
  for (fem::EslSet& set : loads.sets)
    for (int j = 0; j <= kGrid.ny; ++j) {
      const int n = kGrid.node(set.root_column, j);
      set.deformation(2 * n + 1) = -set.held_stretch * kGrid.node_position(0, j).y();
    }
  const VectorXd k = random_factors(kGrid, 1e-3, 10);
  ComplianceEvaluator compliance(loads, kSection, {LoadDefinition::stiffness}, k, k);
  for (int l = 0; l < 3; ++l) {
    const fem::EslSet& set = loads.sets[static_cast<size_t>(l)];
    const Vec2 root(kGrid.node_position(set.root_column, 0).x(), 0);
    VectorXd u = set.deformation;
    for (int n = kGrid.node(set.root_column, 0); n < kGrid.n_nodes(); ++n)
      u.segment<2>(2 * n) += set.thermal_stretch * (kGrid.node_position(n / 11, n % 11) - root);
    EXPECT_LT((compliance.displacement(k, k, l) - u).norm(), 1e-9 * u.norm());
  }
}

TEST(HotCompliance, RefusesStretchesThatAreNone) {
  for (const double bad : {-1.0, std::nan("")}) {
    fem::EslSets loads = hot_plate(2, kStretch);
    loads.sets[1].thermal_stretch = bad;
    const auto make = [&] { ComplianceEvaluator(loads, kSection, {}, {}, {}); };
    const std::string text = error_of(Error::Kind::input, make);
    EXPECT_TRUE(mentions(text, "load 1") && mentions(text, "thermal stretch")) << text;
  }
}

}  // namespace
}  // namespace flexmorph::mmc::test
