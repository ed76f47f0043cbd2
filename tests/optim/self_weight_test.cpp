// Shows that the weight of a static plate, which depends on its design, is correct: a hanging
// column, superposition, Taylor's test.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "optim/mmc/loads/compliance_evaluator.h"

namespace flexmorph::mmc {
namespace {

std::vector<fem::HeldUnknown> held_edge(const Grid& grid, bool top) {
  std::vector<fem::HeldUnknown> out;
  for (int i = 0; i <= grid.nx; ++i)
    for (int c = 0; c < 2; ++c) out.push_back({grid.node(i, top ? grid.ny : 0), c});
  return out;
}

// Reference: u(y) = rho g (L y - y^2 / 2) / E from the held top, which linear elements reproduce
// exactly at their nodes. F . u is the trapezoidal rule for rho g A u: C = rho^2 g^2 A (L^3 / 3 - L
// h^2 / 12) / E.
TEST(SelfWeight, OfAHangingColumn) {
  const fem::PlaneSection section{0.02, 2e9, 0, 1800};
  const double g = 9.81, length = 2, width = 0.3;
  const Grid grid{.width = width, .height = length, .nx = 3, .ny = 8};
  const Plate plate{grid, section, {}};
  const LoadCase alone{"weight", 1, {}};
  ComplianceEvaluator column(plate, held_edge(grid, true), {&alone, 1}, true, Vec2(0, -g));
  const VectorXd full = VectorXd::Ones(grid.n_cells());
  const double h = length / grid.ny, area = width * 0.02, weight = 1800 * g;
  const double exact =
      weight * weight * area * (std::pow(length, 3) / 3 - length * h * h / 12) / 2e9;
  EXPECT_NEAR(column.sum(full, full), exact, 1e-10 * exact);
  EXPECT_NEAR(column.individual(full, full)[0], exact, 1e-10 * exact);
  // Half of the mass and of the stiffness: half of the weight acts on half of the stiffness.
  EXPECT_NEAR(column.sum(0.5 * full, 0.5 * full), 0.5 * exact, 1e-10 * exact);
  EXPECT_FALSE(column.has_curvature());
}

struct Bracket {
  Grid grid{.width = 0.7, .height = 0.4, .nx = 7, .ny = 5};
  Plate plate{grid, {0.01, 1e8, 0.3, 2700}, {}};
  std::vector<LoadCase> loads = {{"tip", 1.5, {{grid.node(7, 2), Vec2(3, -20)}}},
                                 {"top", 0.5, {{grid.node(4, 5), Vec2(-8, 5)}}}};
  Bracket() {
    plate.outside.assign(static_cast<size_t>(grid.n_cells()), 0);
    plate.outside[static_cast<size_t>(grid.cell(6, 4))] = 1;
  }
  /// Returns the bracket with a roller at the right and two held nodes at the left.
  ComplianceEvaluator evaluator(std::span<const LoadCase> of, const Vec2& gravity) const {
    const std::vector<fem::HeldUnknown> held = {
        {grid.node(0, 0), 0}, {grid.node(0, 0), 1}, {grid.node(0, 5), 0}, {grid.node(7, 0), 1}};
    return {plate, held, of, true, gravity};
  }
};

VectorXd random_factors(int n, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(0.2, 1);
  VectorXd out(n);
  for (double& each : out) each = uniform(engine);
  return out;
}

TEST(SelfWeight, IsAddedToEveryLoad) {
  const Bracket b;
  const Vec2 gravity(1.5, -9.81);
  const LoadCase alone{"weight", 1, {}};
  ComplianceEvaluator both = b.evaluator(b.loads, gravity), forces = b.evaluator(b.loads, {0, 0}),
                      weight = b.evaluator({&alone, 1}, gravity);
  const VectorXd k = random_factors(b.grid.n_cells(), 1), m = random_factors(b.grid.n_cells(), 2);
  const VectorXd of_weight = weight.displacement(k, m, 0);
  for (int load = 0; load < 2; ++load) {
    const VectorXd sum = forces.displacement(k, m, load) + of_weight,
                   found = both.displacement(k, m, load);
    EXPECT_LT((found - sum).lpNorm<Eigen::Infinity>(), 1e-12 * found.lpNorm<Eigen::Infinity>());
  }
}

TEST(SelfWeight, TaylorRemaindersAreOfSecondOrder) {
  const Bracket b;
  ComplianceEvaluator both = b.evaluator(b.loads, {1.5, -9.81});
  const int n = b.grid.n_cells();
  const VectorXd k = random_factors(n, 3), m = random_factors(n, 4),
                 dk = random_factors(n, 5).array() - 0.6, dm = random_factors(n, 6).array() - 0.6;
  ComplianceEvaluator::Value at;
  both.evaluate(k, m, at);
  ComplianceEvaluator::Each each;
  both.evaluate_each(k, m, each);
  EXPECT_NEAR(1.5 * each.f[both.position(0)] + 0.5 * each.f[both.position(1)], at.f, 1e-12 * at.f);
  const double slope = at.d_stiffness.dot(dk) + at.d_mass.dot(dm);
  const VectorXd slopes = each.d_stiffness * dk + each.d_mass * dm;
  Eigen::Vector3d before = Eigen::Vector3d::Zero();
  for (double h = 0.04; h > 1e-3; h /= 2) {
    const VectorXd kh = k + h * dk, mh = m + h * dm;
    Eigen::Vector3d rest;
    rest[0] = both.sum(kh, mh) - at.f - h * slope;
    rest.tail<2>() = both.individual(kh, mh) - each.f - h * slopes;
    for (int i = 0; h < 0.01 && i < 3; ++i) {
      EXPECT_NEAR(std::log2(before[i] / rest[i]), 2, 0.05) << h;
    }
    before = rest;
  }
}

}  // namespace
}  // namespace flexmorph::mmc
