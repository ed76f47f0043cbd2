// Shows that the compliance of many equivalent static loads is correct: the motion's own
// deformation is recovered at the unchanged design, every derivative passes Taylor's test, and
// compressed loads give the objective and gradient of all loads.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "optim/mmc/loads/compliance_evaluator.h"
#include "tests/optim/smooth_design.h"
#include "tests/support/sections.h"

namespace flexmorph::mmc {
namespace {

using fem::kThinSection;

/// Returns n loads of a plate that grows at speed v out of a hub rotating with omega, with
/// additional bending and axial vibration. The root moves from column `last` to `first` in steps of
/// `step` columns. The deformation is smooth and vanishes on the root line; it is not the static
/// solution for the accelerations.
fem::EslSets growing_plate(const Grid& g, int n, int last, int first, int step = 1) {
  const double omega = 2 * std::numbers::pi, v = 0.5, pi = std::numbers::pi;
  fem::EslSets loads{g, {}};
  for (int k = 0; k < n; ++k) {
    const double t = n > 1 ? static_cast<double>(k) / (n - 1) : 1.0;
    fem::EslSet set;
    set.time = t;
    set.weight = (1 + 0.3 * std::sin(5 * t)) / n;
    set.root_column = last - step * static_cast<int>(std::lround((last - first) * t / step));
    const double root = g.x0 + set.root_column * g.dx();
    set.deformation.setZero(2 * g.n_nodes());
    set.acceleration.resize(2 * g.n_nodes());
    for (int i = 0; i <= g.nx; ++i) {
      for (int j = 0; j <= g.ny; ++j) {
        const Vec2 X = g.node_position(i, j);
        const double x = X.x() - root, y = X.y() - g.y0 - g.height / 2, z = X.x() / g.width;
        const double bend = 40 * std::cos(19 * t) * z * z + 15 * std::sin(61 * t) * z * z * z;
        const double axial = 8 * std::sin(140 * t) * std::sin(pi * z / 2);
        set.acceleration.segment<2>(2 * g.node(i, j)) =
            Vec2{-omega * omega * x + axial, 2 * omega * v - omega * omega * y + bend};
        if (i <= set.root_column) continue;
        const double s = x / g.width;
        set.deformation.segment<2>(2 * g.node(i, j)) =
            1e-3 * Vec2{s * (1 + std::sin(3 * t + 9 * s + 20 * y)),
                        s * s * (2 + std::cos(4 * t + 7 * s)) + s * y};
      }
    }
    const int tip = g.node(g.nx, g.ny / 2);
    set.forces.push_back({tip, -0.5 * set.acceleration.segment<2>(2 * tip)});
    loads.sets.push_back(std::move(set));
  }
  return loads;
}

const Grid kGrid{0, -0.05, 0.6, 0.1, 36, 6};

struct Choice {
  LoadDefinition loads;
  Support support;
  std::string name;
};

std::vector<Choice> choices() {
  return {{LoadDefinition::inertia, Support::moving_root, "inertia_moving_root"},
          {LoadDefinition::frozen, Support::moving_root, "frozen_moving_root"},
          {LoadDefinition::frozen, Support::far_end, "frozen_far_end"},
          {LoadDefinition::stiffness, Support::moving_root, "stiffness_moving_root"},
          {LoadDefinition::stiffness, Support::far_end, "stiffness_far_end"}};
}

class EveryLoadDefinition : public ::testing::TestWithParam<Choice> {
 protected:
  ComplianceSettings settings(bool compress) const {
    return {GetParam().loads, GetParam().support, compress, 1e-10};
  }
};

INSTANTIATE_TEST_SUITE_P(Table, EveryLoadDefinition, ::testing::ValuesIn(choices()),
                         [](const auto& choice) { return choice.param.name; });

// f(s + h) - f(s) - h f'(s) = O(h^2) over three decades of h. The steps stay above the level where
// round-off of f appears (1e-12, because some cells have a stiffness of 1e-3).
TEST_P(EveryLoadDefinition, TaylorRemainderIsOfSecondOrder) {
  const fem::EslSets loads = growing_plate(kGrid, 6, 12, 2);
  for (bool compress : {false, true}) {
    for (unsigned seed : {1u, 2u, 3u}) {
      const SmoothDesign start(kGrid, seed + 10), design(kGrid, seed);
      ComplianceEvaluator compliance(loads, kThinSection, settings(compress), start.stiffness(0),
                                     start.mass(0));
      ComplianceEvaluator::Value at;
      compliance.evaluate(design.stiffness(0), design.mass(0), at);
      const double f = at.f;
      const double slope =
          at.d_stiffness.dot(design.d_stiffness(0)) + at.d_mass.dot(design.d_mass(0));
      std::vector<double> log_h, log_r;
      for (double h = 1e-2; h > 0.9e-5; h /= std::sqrt(10.0)) {
        compliance.evaluate(design.stiffness(h), design.mass(h), at);
        log_h.push_back(std::log(h));
        log_r.push_back(std::log(std::abs(at.f - f - h * slope)));
      }
      const double order = (log_r.front() - log_r.back()) / (log_h.front() - log_h.back());
      EXPECT_NEAR(order, 2.0, 0.05) << "seed " << seed << (compress ? " compressed" : "");
    }
  }
}

/// Returns random scale factors between `smallest` and 1 for all cells.
VectorXd random_factors(const Grid& g, double smallest, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(std::log(smallest), 0);
  VectorXd factor(g.n_cells());
  for (double& f : factor) f = std::exp(uniform(engine));
  return factor;
}

/// Returns the strain energy of a displacement in the cells inside the hub, and in all cells.
std::pair<double, double> energy_inside(const fem::StaticSolver& solver, const VectorXd& factor,
                                        const VectorXd& at_nodes, int root_column) {
  const Grid& g = solver.grid();
  MatrixXd u(1, solver.n_unknowns());
  for (int i = 0; i <= g.nx; ++i) {
    for (int j = 0; j <= g.ny; ++j) {
      if (const int row = solver.row(g.node(i, j), 0); row >= 0) {
        u.block<1, 2>(0, row) = at_nodes.segment<2>(2 * g.node(i, j)).transpose();
      }
    }
  }
  VectorXd energies;
  solver.cell_energies(u, VectorXd::Ones(1), energies);
  energies.array() *= factor.array();
  return {energies.head(g.cell(root_column, 0)).sum(), energies.sum()};
}

// Static analysis at the design of the motion must return the deformation of the motion.
TEST(Recovery, StiffnessLoadsReturnTheDeformation) {
  const fem::EslSets loads = growing_plate(kGrid, 4, 12, 2);
  for (double smallest : {1e-3, 1e-6}) {
    const VectorXd factor = random_factors(kGrid, smallest, 5);
    for (Support support : {Support::moving_root, Support::far_end}) {
      ComplianceEvaluator compliance(
          loads, kThinSection, {LoadDefinition::stiffness, support, true, 1e-10}, factor, factor);
      const fem::StaticSolver solver(kGrid, kThinSection);
      for (int l = 0; l < 4; ++l) {
        const fem::EslSet& set = loads.sets[static_cast<std::size_t>(l)];
        const VectorXd u = compliance.displacement(factor, factor, l);
        EXPECT_LT((u - set.deformation).norm(), 1e-9 * set.deformation.norm());
        const auto [inside, all] = energy_inside(solver, factor, u, set.root_column);
        EXPECT_LT(inside, 1e-12 * all);
      }
    }
  }
}

// If the reactions on the root line are part of the loads, the plate held at its far end has the
// displacement of the plate held at its root, and its part inside the hub is free of strain.
TEST(Recovery, FrozenLoadsAgreeBetweenSupports) {
  const fem::EslSets loads = growing_plate(kGrid, 4, 12, 2);
  const VectorXd stiffness = random_factors(kGrid, 1e-6, 6), mass = random_factors(kGrid, 1e-2, 7);
  ComplianceEvaluator at_root(loads, kThinSection,
                              {LoadDefinition::frozen, Support::moving_root, true, 1e-10},
                              stiffness, mass);
  ComplianceEvaluator far_end(loads, kThinSection,
                              {LoadDefinition::frozen, Support::far_end, true, 1e-10}, stiffness,
                              mass);
  const fem::StaticSolver solver(kGrid, kThinSection);
  for (int l = 0; l < 4; ++l) {
    const VectorXd expected = at_root.displacement(stiffness, mass, l);
    const VectorXd u = far_end.displacement(stiffness, mass, l);
    EXPECT_LT((u - expected).norm(), 1e-9 * expected.norm());
    const int root = loads.sets[static_cast<std::size_t>(l)].root_column;
    const auto [inside, all] = energy_inside(solver, stiffness, u, root);
    EXPECT_LT(inside, 1e-12 * all);
  }
}

// Frozen loads at their own design equal inertia loads; only the latter depend on its mass.
TEST(Compliance, FrozenEqualsInertiaAtTheStart) {
  const fem::EslSets loads = growing_plate(kGrid, 5, 12, 2);
  const SmoothDesign design(kGrid, 4);
  const VectorXd k = design.stiffness(0), m = design.mass(0);
  ComplianceEvaluator inertia(loads, kThinSection, {}, k, m);
  ComplianceEvaluator frozen(loads, kThinSection,
                             {LoadDefinition::frozen, Support::moving_root, true, 1e-10}, k, m);
  ComplianceEvaluator::Value a, b;
  inertia.evaluate(k, m, a);
  frozen.evaluate(k, m, b);
  EXPECT_NEAR(a.f, b.f, 1e-11 * b.f);
  EXPECT_EQ(b.d_mass.cwiseAbs().maxCoeff(), 0);
  EXPECT_GT(a.d_mass.cwiseAbs().maxCoeff(), 0);
}

// One column of cells under a uniform acceleration along x. Reference: a rod under its own weight.
TEST(Compliance, ARodUnderItsOwnWeightHasTheCompliance) {
  const Grid g{0, 0, 1.0, 0.01, 200, 1};
  fem::PlaneSection section = kThinSection;
  section.poisson_ratio = 0;
  fem::EslSets loads{g, {{}}};
  loads.sets[0].acceleration = VectorXd::Zero(2 * g.n_nodes());
  for (int n = 0; n < g.n_nodes(); ++n) loads.sets[0].acceleration(2 * n) = -9.81;
  loads.sets[0].root_column = 80;  // 0.6 m are outside of the hub
  ComplianceEvaluator compliance(loads, section, {}, {}, {});
  const VectorXd ones = VectorXd::Ones(g.n_cells());
  ComplianceEvaluator::Value value;
  compliance.evaluate(ones, ones, value);
  // f = q^2 L^3 / (3 E A) for q per length; linear elements give 1 - 1/(4 n^2) of this value
  const double A = 1e-4, q = 9.81 * 2700 * A, L = 0.6;
  EXPECT_NEAR(value.f, q * q * L * L * L / (3 * 1e8 * A), 1e-4 * value.f);
  EXPECT_NEAR(compliance.individual(ones, ones)(0), value.f, 1e-11 * value.f);
  EXPECT_EQ(value.d_stiffness.head(80).cwiseAbs().maxCoeff(), 0);
  EXPECT_NEAR(value.d_stiffness.sum(), -value.f, 1e-11 * value.f);  // f ~ 1 / k
  EXPECT_NEAR(value.d_mass.sum(), 2 * value.f, 1e-11 * value.f);    // f ~ m^2
}

// Compression changes neither objective nor gradient, for all load definitions.
TEST_P(EveryLoadDefinition, CompressionChangesNothing) {
  const fem::EslSets loads = growing_plate(kGrid, 40, 20, 1);
  const SmoothDesign start(kGrid, 20);
  ComplianceEvaluator all(loads, kThinSection, settings(false), start.stiffness(0), start.mass(0));
  ComplianceEvaluator few(loads, kThinSection, settings(true), start.stiffness(0), start.mass(0));
  EXPECT_EQ(all.n_right_hand_sides(), 40);
  if (GetParam().loads == LoadDefinition::inertia) {
    // x, y of the rotation, Coriolis and root speed, three modes, components of the tip force
    EXPECT_LE(few.n_right_hand_sides(), 8);
  }
  for (unsigned seed : {1u, 2u}) {
    const SmoothDesign design(kGrid, seed);
    // Solid and void as in a final design: the void has no mass.
    VectorXd k = design.stiffness(0), m = design.mass(0);
    if (seed == 2u) {
      for (int c = 0; c < kGrid.n_cells(); ++c) {
        const bool solid = m(c) > 0.5 || c % kGrid.ny == 2;
        k(c) = solid ? 1 : 1e-6;
        m(c) = solid ? 1 : 0;
      }
    }
    ComplianceEvaluator::Value a, b;
    all.evaluate(k, m, a);
    few.evaluate(k, m, b);
    EXPECT_NEAR(a.f, b.f, 1e-8 * a.f);
    EXPECT_LT((a.d_stiffness - b.d_stiffness).norm(), 1e-8 * a.d_stiffness.norm());
    EXPECT_LE((a.d_mass - b.d_mass).norm(), 1e-8 * a.d_mass.norm());
    EXPECT_NEAR(all.sum(k, m), a.f, 1e-8 * a.f);
    EXPECT_NEAR(few.sum(k, m), a.f, 1e-8 * a.f);
    const VectorXd individual = few.individual(k, m);
    double sum = 0;
    for (int l = 0; l < 40; ++l) {
      sum += loads.sets[static_cast<std::size_t>(l)].weight * individual(l);
    }
    EXPECT_NEAR(sum, a.f, 1e-8 * a.f);
  }
}

// The far end is one support for all loads, but each location of the root line has its own
// reactions. Few locations need few right-hand sides.
TEST(Compression, FarEndWithFewRootColumns) {
  const fem::EslSets loads = growing_plate(kGrid, 40, 20, 0, 10);
  const SmoothDesign start(kGrid, 20), design(kGrid, 1);
  for (LoadDefinition definition : {LoadDefinition::frozen, LoadDefinition::stiffness}) {
    ComplianceEvaluator all(loads, kThinSection, {definition, Support::far_end, false, 0},
                            start.stiffness(0), start.mass(0));
    ComplianceEvaluator few(loads, kThinSection, {definition, Support::far_end, true, 1e-10},
                            start.stiffness(0), start.mass(0));
    EXPECT_LT(few.n_right_hand_sides(), 25);
    ComplianceEvaluator::Value a, b;
    all.evaluate(design.stiffness(0), design.mass(0), a);
    few.evaluate(design.stiffness(0), design.mass(0), b);
    EXPECT_NEAR(a.f, b.f, 1e-8 * a.f);
    EXPECT_LT((a.d_stiffness - b.d_stiffness).norm(), 1e-8 * a.d_stiffness.norm());
  }
}

// A root that does not move is a single support. Loads may have zero weight and any order.
TEST(Compression, OneRootColumnNeedsFewSolves) {
  fem::EslSets loads = growing_plate(kGrid, 30, 4, 4);
  loads.sets[7].weight = 0;
  const SmoothDesign design(kGrid, 1);
  ComplianceEvaluator all(loads, kThinSection,
                          {LoadDefinition::inertia, Support::moving_root, false, 0}, {}, {});
  ComplianceEvaluator few(loads, kThinSection, {}, {}, {});
  EXPECT_LE(few.n_right_hand_sides(), 8);
  ComplianceEvaluator::Value a, b;
  all.evaluate(design.stiffness(0), design.mass(0), a);
  few.evaluate(design.stiffness(0), design.mass(0), b);
  EXPECT_NEAR(a.f, b.f, 1e-8 * a.f);
  EXPECT_NEAR(few.sum(design.stiffness(0), design.mass(0)), a.f, 1e-8 * a.f);
  EXPECT_LT((a.d_mass - b.d_mass).norm(), 1e-8 * a.d_mass.norm());
}

// A strip of two cells with more loads than unknowns.
TEST(Compression, ATinyPlate) {
  const Grid g{0, 0, 0.2, 0.1, 2, 1};
  const fem::EslSets loads = growing_plate(g, 12, 1, 0);
  const VectorXd ones = VectorXd::Ones(2);
  for (Support support : {Support::moving_root, Support::far_end}) {
    ComplianceEvaluator::Value a, b;
    ComplianceEvaluator(loads, kThinSection, {LoadDefinition::frozen, support, false, 0}, ones,
                        ones)
        .evaluate(ones, ones, a);
    ComplianceEvaluator few(loads, kThinSection, {LoadDefinition::frozen, support, true, 1e-10},
                            ones, ones);
    few.evaluate(ones, ones, b);
    EXPECT_NEAR(a.f, b.f, 1e-8 * a.f);
    if (support == Support::far_end) {
      EXPECT_LE(few.n_right_hand_sides(), 8);
    }
  }
}

TEST(Compression, OrderAndZeroWeightsDoNotMatter) {
  fem::EslSets loads = growing_plate(kGrid, 30, 20, 1);
  loads.sets[7].weight = 0;
  const SmoothDesign design(kGrid, 1);
  ComplianceEvaluator::Value sorted, shuffled;
  ComplianceEvaluator(loads, kThinSection, {}, {}, {})
      .evaluate(design.stiffness(0), design.mass(0), sorted);
  std::shuffle(loads.sets.begin(), loads.sets.end(), std::mt19937(3));
  ComplianceEvaluator few(loads, kThinSection, {}, {}, {});
  few.evaluate(design.stiffness(0), design.mass(0), shuffled);
  EXPECT_LT(few.n_right_hand_sides(), 10);
  EXPECT_NEAR(sorted.f, shuffled.f, 1e-9 * sorted.f);
  EXPECT_NEAR(few.sum(design.stiffness(0), design.mass(0)), sorted.f, 1e-9 * sorted.f);
  EXPECT_LT((sorted.d_stiffness - shuffled.d_stiffness).norm(), 1e-9 * sorted.d_stiffness.norm());
  EXPECT_LT((sorted.d_mass - shuffled.d_mass).norm(), 1e-9 * sorted.d_mass.norm());
}

TEST(Compliance, RefusesWithTheReason) {
  const fem::EslSets good = growing_plate(kGrid, 3, 6, 2);
  const VectorXd ones = VectorXd::Ones(kGrid.n_cells());
  const auto message = [&](const fem::EslSets& loads, const ComplianceSettings& settings,
                           const VectorXd& k0) {
    try {
      ComplianceEvaluator(loads, kThinSection, settings, k0, ones);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), Error::Kind::input);
      return std::string(error.what());
    }
    return std::string();
  };
  const ComplianceSettings far_inertia{LoadDefinition::inertia, Support::far_end, true, 1e-10};
  EXPECT_NE(message(good, far_inertia, ones).find("'inertia'"), std::string::npos);
  EXPECT_NE(message({kGrid, {}}, {}, ones).find("no loads"), std::string::npos);
  EXPECT_EQ(message(good, {}, ones), "");
  fem::EslSets bad = good;
  bad.sets[1].root_column = kGrid.nx;
  EXPECT_NE(message(bad, {}, ones).find("load 1"), std::string::npos);
  bad = good;
  bad.sets[2].acceleration(5) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(message(bad, {}, ones).find("load 2"), std::string::npos);
  bad = good;
  bad.sets[0].forces.push_back({kGrid.n_nodes(), {1, 0}});
  EXPECT_NE(message(bad, {}, ones).find("load 0"), std::string::npos);
  bad = good;
  for (fem::EslSet& set : bad.sets) set.weight = 0;
  EXPECT_NE(message(bad, {}, ones).find("weights"), std::string::npos);
  const ComplianceSettings frozen{LoadDefinition::frozen, Support::far_end, true, 1e-10};
  EXPECT_NE(message(good, frozen, VectorXd::Ones(3)).find("factors"), std::string::npos);

  ComplianceEvaluator compliance(good, kThinSection, {}, ones, ones);
  ComplianceEvaluator::Value value;
  EXPECT_THROW(compliance.evaluate(-ones, ones, value), Error);
  VectorXd nan = ones;
  nan(3 * kGrid.nx) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(compliance.evaluate(nan, ones, value), Error);
  EXPECT_THROW(compliance.evaluate(ones, nan, value), Error);
  EXPECT_THROW(compliance.displacement(ones, ones, 3), Error);
  compliance.evaluate(ones, ones, value);
  EXPECT_GT(value.f, 0);
}

}  // namespace
}  // namespace flexmorph::mmc
