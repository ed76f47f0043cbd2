// Shows that design problems with static loads are correct: sums and worst cases of many loads,
// volume under a compliance limit. Derivatives are compared with differences, the worst case with
// its definition, and compressed loads with the sum over all loads.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "optim/mmc/loads/compliance_evaluator.h"
#include "tests/optim/mmc_small.h"
#include "tests/support/gradient_check.h"

namespace flexmorph::mmc::test {
namespace {

std::vector<fem::HeldUnknown> clamp() {
  std::vector<fem::HeldUnknown> held;
  for (int j = 0; j <= kGrid.ny; ++j)
    for (int c = 0; c < 2; ++c) held.push_back({kGrid.node(0, j), c});
  return held;
}

/// Returns n loads that pull at the free end and at the middle; three of them are independent.
std::vector<LoadCase> loads(int n) {
  std::vector<LoadCase> all;
  const int tip = kGrid.node(kGrid.nx, kGrid.ny / 2), middle = kGrid.node(kGrid.nx / 2, kGrid.ny);
  for (int l = 0; l < n; ++l)
    all.push_back({"load_" + std::to_string(l + 1),
                   1 + 0.1 * l,
                   {{tip, Vec2(std::cos(l), 2)}, {middle, Vec2(0, 3 * std::sin(2 * l))}}});
  return all;
}

ComplianceEvaluator plate(int n, bool compress) {
  return ComplianceEvaluator({kGrid, kSection, {}}, clamp(), loads(n), compress);
}

VectorXd random_factors(unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(0.1, 1);
  VectorXd f(kGrid.n_cells());
  for (double& each : f) each = uniform(engine);
  return f;
}

TEST(ComplianceEvaluator, DerivativesAgreeWithDifferences) {
  ComplianceEvaluator plate4 = plate(4, false);
  const VectorXd b = random_factors(1), mass = b;
  ComplianceEvaluator::Value value, plus, minus;
  ComplianceEvaluator::Each each, each_plus, each_minus;
  plate4.evaluate(b, mass, value);
  plate4.evaluate_each(b, mass, each);
  for (const int cell : {0, 77, 311, 599}) {
    VectorXd up = b, down = b;
    const double h = 1e-5;
    up[cell] += h;
    down[cell] -= h;
    plate4.evaluate(up, mass, plus);
    plate4.evaluate(down, mass, minus);
    // Central differences have an error of h² f'''/6, f''' ~ f/b³.
    EXPECT_NEAR(value.d_stiffness[cell], (plus.f - minus.f) / (2 * h),
                1e-6 * std::abs(value.d_stiffness[cell]) + 1e-9 * value.f);
    plate4.evaluate_each(up, mass, each_plus);
    plate4.evaluate_each(down, mass, each_minus);
    for (int l = 0; l < 4; ++l)
      EXPECT_NEAR(each.d_stiffness(l, cell), (each_plus.f[l] - each_minus.f[l]) / (2 * h),
                  1e-6 * std::abs(each.d_stiffness(l, cell)) + 1e-9 * each.f[l]);
  }
  EXPECT_EQ(value.d_mass.norm(), 0);
}

TEST(ComplianceEvaluator, TheSumIsThatOfItsLoadsWithOrWithoutCompression) {
  ComplianceEvaluator all = plate(9, false), few = plate(9, true);
  EXPECT_EQ(all.n_right_hand_sides(), 9);
  EXPECT_EQ(few.n_right_hand_sides(), 3);
  const VectorXd b = random_factors(2);
  ComplianceEvaluator::Value a, c;
  ComplianceEvaluator::Each each;
  all.evaluate(b, b, a);
  few.evaluate(b, b, c);
  few.evaluate_each(b, b, each);
  double sum = 0;
  VectorXd gradient = VectorXd::Zero(kGrid.n_cells());
  for (int l = 0; l < 9; ++l) {
    sum += (1 + 0.1 * l) * each.f[l];
    gradient += (1 + 0.1 * l) * each.d_stiffness.row(l);
  }
  EXPECT_NEAR(a.f, sum, 1e-11 * sum);
  EXPECT_NEAR(c.f, sum, 1e-9 * sum);
  EXPECT_LT((a.d_stiffness - gradient).norm(), 1e-11 * gradient.norm());
  EXPECT_LT((c.d_stiffness - gradient).norm(), 1e-8 * gradient.norm());
  // The difference is due to two substitutions with a stiffness matrix of condition number about
  // 1e6.
  EXPECT_LT((few.individual(b, b) - each.f).norm(), 1e-9 * each.f.norm());
}

TEST(ComplianceEvaluator, ComplianceIsTheWorkOfTheForces) {
  ComplianceEvaluator plate3 = plate(3, false);
  const VectorXd b = random_factors(3);
  const VectorXd C = plate3.individual(b, b);
  const std::vector<LoadCase> all = loads(3);
  for (int l = 0; l < 3; ++l) {
    const VectorXd u = plate3.displacement(b, b, l);
    double work = 0;
    for (const fem::NodalForce& f : all[static_cast<size_t>(l)].forces)
      work += f.force.dot(u.segment<2>(2 * f.node));
    EXPECT_NEAR(C[l], work, 1e-11 * C[l]);
  }
}

TEST(ComplianceEvaluator, RefusesLoadsThatDoNothing) {
  std::vector<LoadCase> held = {{"held", 1, {{kGrid.node(0, 3), Vec2(1, 0)}}}};
  EXPECT_THROW(ComplianceEvaluator({kGrid, kSection, {}}, clamp(), held, false), Error);
  EXPECT_THROW(ComplianceEvaluator({kGrid, kSection, {}}, clamp(), {}, false), Error);
}

// Loads that depend on the design, with a moving root: individual values against their sum and
// against differences.
TEST(Compliance, EveryLoadByItself) {
  const fem::EslSets sets = turning_plate(4);
  ComplianceEvaluator compliance(sets, kSection, {}, {}, {});
  const VectorXd k = random_factors(4), m = random_factors(5);
  ComplianceEvaluator::Value value;
  ComplianceEvaluator::Each each, plus, minus;
  compliance.evaluate(k, m, value);
  compliance.evaluate_each(k, m, each);
  VectorXd by_k = VectorXd::Zero(kGrid.n_cells()), by_m = by_k;
  double sum = 0;
  for (int l = 0; l < 4; ++l) {
    const double w = sets.sets[static_cast<size_t>(l)].weight;
    sum += w * each.f[l];
    by_k += w * each.d_stiffness.row(l);
    by_m += w * each.d_mass.row(l);
  }
  EXPECT_NEAR(value.f, sum, 1e-8 * sum);  // evaluate() uses compressed loads
  EXPECT_LT((value.d_stiffness - by_k).norm(), 1e-7 * by_k.norm());
  EXPECT_LT((value.d_mass - by_m).norm(), 1e-7 * by_m.norm());
  EXPECT_LT((compliance.individual(k, m) - each.f).norm(), 1e-10 * each.f.norm());

  const VectorXd along_k = 1e-5 * (random_factors(6).array() - 0.5).matrix(), along_m = along_k;
  compliance.evaluate_each(k + along_k, m + along_m, plus);
  compliance.evaluate_each(k - along_k, m - along_m, minus);
  for (int l = 0; l < 4; ++l) {
    const double slope = each.d_stiffness.row(l).dot(along_k) + each.d_mass.row(l).dot(along_m);
    EXPECT_NEAR(slope, (plus.f[l] - minus.f[l]) / 2, 1e-6 * std::abs(slope) + 1e-13 * each.f[l]);
  }
}

struct Asked {
  const char* name;
  Goal goal;
};

class EveryGoal : public ::testing::TestWithParam<Asked> {};
INSTANTIATE_TEST_SUITE_P(
    Table, EveryGoal,
    ::testing::Values(Asked{"compliance_sum", least_compliance()},
                      Asked{"compliance_worst", least_compliance(0.5, kComplianceWorst)},
                      Asked{"volume_sum", least_volume(2)},
                      Asked{"volume_worst", least_volume(2, kComplianceWorst)}),
    [](const auto& test) { return std::string(test.param.name); });

// Every row of the response is compared with central differences along a random direction of a
// hundredth of a cell; the terms of third order from the smoothed band are far below the
// derivative.
TEST_P(EveryGoal, GradientsAgreeWithDifferences) {
  const Design design(kGrid, random_layout(3), kScale);
  const Ersatz ersatz(kGrid, tdf_settings().alpha, strip(), {});
  ComplianceEvaluator statics = plate(5, !compliance_row(GetParam().goal).per_load);
  MmcProblem problem({kPlate, design, ersatz, statics}, tdf_settings(), GetParam().goal);
  const VectorXd x = problem.start();
  ASSERT_EQ(x.size(), problem.n_variables());
  ASSERT_EQ(problem.lower().size(), x.size());
  EXPECT_TRUE((problem.lower().array() <= x.array()).all());
  EXPECT_TRUE((x.array() <= problem.upper().array()).all());
  std::mt19937 engine(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  VectorXd along(x.size());
  for (double& each : along) each = 1e-5 * uniform(engine);
  const optim::ProblemValues at = problem.evaluate(x);
  ASSERT_EQ(at.g.size(), problem.n_constraints());
  const optim::ProblemValues plus = problem.evaluate(x + along),
                             minus = problem.evaluate(x - along);
  EXPECT_NEAR(at.df.dot(along), (plus.f - minus.f) / 2, 1e-4 * std::abs(at.df.dot(along)) + 1e-11);
  for (Eigen::Index i = 0; i < at.g.size(); ++i) {
    const double slope = at.dg.row(i).dot(along);
    EXPECT_NEAR(slope, (plus.g[i] - minus.g[i]) / 2, 1e-4 * std::abs(slope) + 1e-11) << i;
  }
}

TEST(WorstCase, BoundsEveryLoadAndStartsAtTheLargest) {
  const Design design(kGrid, layout(), kScale);
  const Ersatz ersatz(kGrid, tdf_settings().alpha, strip(), {});
  ComplianceEvaluator statics = plate(5, false);
  MmcProblem problem({kPlate, design, ersatz, statics}, tdf_settings(),
                     least_compliance(0.5, kComplianceWorst));
  const optim::ProblemValues r = problem.evaluate(problem.start());
  const VectorXd C = *problem.values(kComplianceWorst);
  EXPECT_NEAR(r.f, std::log(C.maxCoeff()), 1e-12);
  EXPECT_EQ(problem.compliance(), C.maxCoeff());
  EXPECT_NEAR(r.g.tail(5).maxCoeff(), 0, 1e-12);
  for (int l = 0; l < 5; ++l) EXPECT_NEAR(r.g[1 + l], std::log(C[l] / C.maxCoeff()), 1e-12);
}

struct Designed {
  BodyOutcome outcome;
  double worst;  ///< Largest compliance of the smoothed design.
};

/// Designs a small plate for a goal. (With ten cells across, only smoothed designs are meaningful.)
Designed designed(const Goal& goal, int n_loads, int iterations) {
  TdfSettings tdf = tdf_settings();
  tdf.erosion = 0;
  BodyProblem problem = body_of(Design(kGrid, layout(), kScale), {tdf}, goal);
  ComplianceEvaluator statics = plate(n_loads, !compliance_row(goal).per_load);
  DesignSettings settings;
  settings.optimizer.max_iterations = iterations;
  bool is_running = true;
  const BodyOutcome outcome = design_body(problem, statics, 1, settings, {}, is_running);
  const Ersatz ersatz = ersatz_of(problem);
  MmcProblem all({kPlate, problem.design, ersatz, statics}, tdf,
                 least_compliance(0.5, kComplianceWorst));
  return {outcome, std::exp(all.evaluate(all.start()).f)};
}

// The worst case distributes compliance evenly over the loads: its largest compliance is lower than
// that of the design for the sum.
TEST(WorstCase, HasALowerWorstLoadThanTheSum) {
  const Designed sum = designed(least_compliance(), 5, 150);
  const Designed worst = designed(least_compliance(0.5, kComplianceWorst), 5, 150);
  EXPECT_LE(sum.outcome.volume, 0.5 * (1 + 1e-4));
  EXPECT_LE(worst.outcome.volume, 0.5 * (1 + 1e-4));
  EXPECT_LT(worst.worst, sum.worst);
  EXPECT_NEAR(worst.worst, worst.outcome.compliance, 1e-10 * worst.worst);
}

}  // namespace
}  // namespace flexmorph::mmc::test
