#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "optim/mmc/loads/compliance_evaluator.h"
#include "tests/optim/mmc_small.h"

/// Hot plates for tests.
namespace flexmorph::mmc::test {

/// Returns random factors between `smallest` and 1, uniformly distributed in their logarithm.
inline VectorXd random_factors(const Grid& g, double smallest, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(std::log(smallest), 0);
  VectorXd factor(g.n_cells());
  for (double& f : factor) f = std::exp(uniform(engine));
  return factor;
}

/// Returns turning_plate() with temperatures: each load has another thermal stretch of up to `a`.
/// Accelerations and forces are reduced until the held expansion has about the energy of the loads.
/// The edge in the hub is held completely, or expands freely if `edge_grows`.
inline fem::EslSets hot_plate(int n, double a, bool edge_grows = false) {
  fem::EslSets loads = turning_plate(n);
  for (int l = 0; l < n; ++l) {
    fem::EslSet& set = loads.sets[static_cast<size_t>(l)];
    set.acceleration *= 0.025;
    for (fem::NodalForce& f : set.forces) f.force *= 0.025;
    set.thermal_stretch = l == 1 ? -0.3 * a : a / (1 + 0.2 * l);
    set.held_stretch = edge_grows ? 0 : set.thermal_stretch;
  }
  return loads;
}

/// Thermal stretch of steel at 300 K above the reference temperature.
inline constexpr double kStretch = 4e-3;

/// Returns the given components of all nodes of column i.
inline std::vector<fem::HeldUnknown> edge(int i, std::vector<int> components) {
  std::vector<fem::HeldUnknown> held;
  for (int j = 0; j <= kGrid.ny; ++j)
    for (const int c : components) held.push_back({kGrid.node(i, j), c});
  return held;
}

inline std::vector<fem::HeldUnknown> operator+(std::vector<fem::HeldUnknown> a,
                                               const std::vector<fem::HeldUnknown>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// Reference solution of one load: wᵀ K w, its derivative with respect to the stiffness factors,
/// and w.
struct Found {
  double compliance = 0;
  VectorXd derivative, w;
};

/// Allowed relative errors: of a load, of individual() compared with it, of the sum and of its
/// derivative.
struct Allowed {
  double load, individual, sum, d_sum;
};

/// Returns the total displacement: the elastic displacement and the expansion about the root.
inline VectorXd whole(const VectorXd& w, const fem::EslSet& set, const Grid& g) {
  const Vec2 root(g.node_position(set.root_column, 0).x(), 0);
  VectorXd u = w;
  for (int n = g.node(set.root_column, 0); n < g.n_nodes(); ++n)
    u.segment<2>(2 * n) +=
        set.thermal_stretch * (g.node_position(n / (g.ny + 1), n % (g.ny + 1)) - root);
  return u;
}

/// Compares all results of Compliance for `inertia` loads with the reference `found(load)`.
template <class FoundOf>
void expect_answers(const fem::EslSets& loads, const VectorXd& k, const VectorXd& m, bool compress,
                    const Allowed& allowed, const FoundOf& found) {
  ComplianceEvaluator compliance(loads, kSection, {.compress = compress}, {}, {});
  ComplianceEvaluator::Value value;
  ComplianceEvaluator::Each each;
  compliance.evaluate(k, m, value);
  compliance.evaluate_each(k, m, each);
  const VectorXd individual = compliance.individual(k, m);
  const Grid& g = loads.grid;
  double sum = 0;
  VectorXd d_sum = VectorXd::Zero(k.size());
  for (int l = 0; l < compliance.n_loads(); ++l) {
    const fem::EslSet& set = loads.sets[static_cast<size_t>(l)];
    const Found expected = found(static_cast<size_t>(l));
    sum += set.weight * expected.compliance;
    d_sum += set.weight * expected.derivative;
    EXPECT_NEAR(each.f(l), expected.compliance, allowed.load * expected.compliance) << l;
    EXPECT_NEAR(individual(l), each.f(l), allowed.individual * each.f(l)) << l;
    EXPECT_LT((each.d_stiffness.row(l).transpose() - expected.derivative).norm(),
              allowed.load * expected.derivative.norm())
        << l;
    const VectorXd u = whole(expected.w, set, g);
    EXPECT_LT((compliance.displacement(k, m, l) - u).norm(), allowed.load * u.norm()) << l;
  }
  EXPECT_NEAR(value.f, sum, allowed.sum * sum);
  EXPECT_LT((value.d_stiffness - d_sum).norm(), allowed.d_sum * d_sum.norm());
}

}  // namespace flexmorph::mmc::test
