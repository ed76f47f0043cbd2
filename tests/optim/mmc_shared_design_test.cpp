// Shows that designs of bodies that share one budget of mass are correct: equal bodies get equal
// shares, the body with the larger load gets more, and the separate data of the bodies (bands,
// removals, post-processing, rows, order of outcomes) are kept. A run of cycles gives a table.

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "tests/optim/mmc_sharing.h"

namespace flexmorph::mmc::test {
namespace {

/// Returns a body for complete runs. (Erosion by half a cell is not used in evaluations, because
/// ten cells across are too few.)
BodyProblem body(const std::string& name, std::vector<double> bands = {1.5}) {
  std::vector<TdfSettings> settings;
  for (const double band : bands) settings.push_back(tdf_settings(band));
  BodyProblem out = body_of(Design(kGrid, layout(), kScale), settings);
  out.body = name;
  out.shares_mass = true;
  return out;
}

struct Designed {
  BodyProblem a, b;
  std::vector<BodyOutcome> outcomes;
  double compliance() const { return outcomes[0].compliance + outcomes[1].compliance; }
};

DesignSettings settings_of(const std::string& optimizer, int iterations) {
  DesignSettings settings;
  settings.crisp_every = 0;
  settings.optimizer.name = optimizer;
  settings.optimizer.max_iterations = iterations;
  if (optimizer == "ipopt") settings.optimizer.options["box"] = 0.1;  // as cases have it
  return settings;
}

/// Designs two equal bodies with forces at their tips, with a common or with separate budgets.
Designed designed(const std::string& optimizer, int iterations, double force_a, double force_b,
                  bool together) {
  Designed out{body("a"), body("b"), {}};
  ComplianceEvaluator loads_a = tip_load(kSection, force_a), loads_b = tip_load(kSection, force_b);
  const DesignSettings settings = settings_of(optimizer, iterations);
  bool is_running = true;
  if (together) {
    const LoadedBody bodies[] = {{out.a, loads_a}, {out.b, loads_b}};
    out.outcomes = design_bodies(bodies, 1, settings, {}, is_running);
  } else {
    out.outcomes = {design_body(out.a, loads_a, 1, settings, {}, is_running),
                    design_body(out.b, loads_b, 1, settings, {}, is_running)};
  }
  return out;
}

/// Returns whether material connects both ends, including cells of a tenth of the density. (Ten
/// cells across are too few for crisp designs of such thin components.)
bool hangs_together(const BodyProblem& p) {
  UnionTdf tdf(p.grid, p.bands.back());
  tdf.evaluate(p.design.components());
  CellScaleFactors factors;
  ersatz_of(p).factors(tdf.density(), tdf.eroded(), factors);
  return connectivity(p.grid, 5 * factors.mass, {}).connected;
}

class EveryOptimizer : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Table, EveryOptimizer, ::testing::ValuesIn(optim::optimizer_names()),
                         [](const auto& test) { return test.param; });

// By symmetry equal bodies stay equal up to round-off, which few iterations amplify little: the
// condition number of the systems is about 1e6, therefore one evaluation differs by 1e-10.
TEST_P(EveryOptimizer, EqualBodiesShareEqually) {
  const Designed start = designed(GetParam(), 1, 1, 1, true);
  const Designed both = designed(GetParam(), 4, 1, 1, true);
  const BodyOutcome &a = both.outcomes[0], &b = both.outcomes[1];
  EXPECT_NE(both.compliance(), start.compliance());
  EXPECT_NEAR(a.volume, b.volume, 1e-6);
  EXPECT_NEAR(a.compliance, b.compliance, 1e-6 * a.compliance);
}

// Ten times the force is a hundred times the compliance. Mass goes to this body until additional
// mass saves equally much in both bodies, and the sum of compliances is lower than with separate
// budgets.
TEST_P(EveryOptimizer, MassGoesWhereTheLoadIs) {
  const Designed apart = designed(GetParam(), 80, 10, 1, false);
  const Designed both = designed(GetParam(), 80, 10, 1, true);
  const BodyOutcome &a = both.outcomes[0], &b = both.outcomes[1];
  RecordProperty("volume_a", std::to_string(a.volume));
  RecordProperty("volume_b", std::to_string(b.volume));
  RecordProperty("compliance_ratio", std::to_string(both.compliance() / apart.compliance()));
  EXPECT_GT(a.volume, b.volume + 0.1);
  EXPECT_LE(a.volume + b.volume, 1 + 1e-4);
  EXPECT_LT(both.compliance(), apart.compliance());
  EXPECT_TRUE(hangs_together(both.a));
  EXPECT_TRUE(hangs_together(both.b));
}

// There is a row per body and iteration, which describes the body's own design; the violation is
// that of the budget.
TEST(DesignBodies, RowsDescribeTheirBodies) {
  for (const char* name : {"mma", "nlopt_ccsaq"}) {
    BodyProblem a = body("a", {2, 1}), b = body("b", {3, 2, 1.5, 1});
    b.section = kSecondSection;
    b.goal = least_compliance(0.3);
    ComplianceEvaluator loads_a = tip_load(kSection, 2), loads_b = tip_load(kSecondSection, 1);
    ComplianceEvaluator again_a = tip_load(kSection, 2), again_b = tip_load(kSecondSection, 1);
    const Ersatz ersatz = ersatz_of(a);
    std::map<int, std::pair<double, double>> sums;  // compliance, and mass divided by the budget
    std::map<std::string, std::vector<double>> bands;
    int rows = 0;
    const double mass_a = full_mass_of(a), mass_b = full_mass_of(b);
    EXPECT_NEAR(mass_a, 2700 * 0.01 * 0.06, 1e-12);
    EXPECT_NEAR(mass_b, 900 * 0.02 * 0.06, 1e-12);
    const auto observe = [&](const IterationReport& r) {
      const bool first = r.problem.body == "a";
      EXPECT_EQ(first, rows++ % 2 == 0);
      EXPECT_EQ(r.iteration, (rows + 1) / 2);
      EXPECT_EQ(r.state.x(), *r.iterate.x);
      EXPECT_EQ(r.crisp != nullptr, r.iteration % 8 == 0);
      EXPECT_TRUE(first || r.iterate.seconds == 0);
      const Design design(kGrid, r.state.components(), kScale);
      TdfSettings tdf = tdf_settings(r.state.band() / kGrid.dx());
      tdf.erosion = 0;
      const Plate& plate = first ? kPlate : kOtherPlate;
      MmcProblem again({plate, design, ersatz, first ? again_a : again_b}, tdf, least_compliance());
      again.evaluate(design.x());
      EXPECT_NEAR(again.compliance(), r.state.compliance(), 1e-9 * again.compliance());
      EXPECT_EQ(&r.value, &r.state.value());
      auto& [compliance, mass] = sums[r.iteration];
      compliance += again.compliance();
      mass += (first ? mass_a : mass_b) * again.volume() / (0.5 * mass_a + 0.3 * mass_b);
      if (!first) {
        EXPECT_NEAR(r.iterate.response->f, std::log(compliance), 1e-9);
        EXPECT_NEAR(r.iterate.violation, std::max(0.0, mass - 1), 1e-9);
      }
      std::vector<double>& seen = bands[r.problem.body];
      const double band = r.state.band() / kGrid.dx();
      if (seen.empty() || std::abs(seen.back() - band) > 1e-9) seen.push_back(band);
      return true;
    };
    DesignSettings settings = settings_of(name, 12);
    settings.crisp_every = 8;
    bool is_running = false;
    const LoadedBody bodies[] = {{a, loads_a}, {b, loads_b}};
    const auto outcomes = design_bodies(bodies, 1, settings, observe, is_running);
    EXPECT_TRUE(is_running);
    ASSERT_EQ(outcomes.size(), 2u);
    EXPECT_EQ(rows, 2 * outcomes[0].iterations);
    EXPECT_EQ(outcomes[0].evaluations, outcomes[1].evaluations);
    EXPECT_GE(outcomes[0].evaluations, 12);
    ASSERT_EQ(bands["a"].size(), 2u);
    ASSERT_EQ(bands["b"].size(), 4u);
    EXPECT_NEAR(bands["b"][2], 1.5, 1e-12);
    // There is one factorization per evaluation of a body. Further ones are: the best design of
    // each of four stages, one crisp design in between, and the final crisp and uniform designs.
    EXPECT_LE(outcomes[0].factorizations, outcomes[0].evaluations + 4 + 1 + 2);
  }
}

// Components outside of the domain carry no load: they are removed from their body, and the other
// body keeps its components. Both bodies together keep the budget, measured by crisp outlines.
TEST(DesignBodies, WidthsAndRemovalsKeepTheBudget) {
  constexpr double kWanted = 0.018;
  BodyProblem a = body("a"), b = body("b");
  std::vector<Component> bars =
      crossing_layout(kGrid.x0, kGrid.y0, kGrid.width, kGrid.height, 4, 1, 0.012, 0.09);
  b.design = b.design.with(bars);
  for (int k = 0; k < 3; ++k) {
    bars.push_back(bars[0]);
    bars.back().center = {0.8, 0.05 * k};
  }
  a.design = a.design.with(bars);
  a.widths = {kWanted, 0.01};
  const int of_b = b.design.n_components();
  ComplianceEvaluator loads_a = tip_load(kSection, 3), loads_b = tip_load(kSection, 1);
  bool is_running = true;
  const LoadedBody bodies[] = {{a, loads_a}, {b, loads_b}};
  const auto outcomes = design_bodies(bodies, 1, settings_of("mma", 240), {}, is_running);
  ASSERT_TRUE(outcomes[0].length_scale);
  EXPECT_FALSE(outcomes[1].length_scale);
  EXPECT_GE(outcomes[0].length_scale->removed, 3);
  EXPECT_EQ(a.design.n_components(),
            static_cast<int>(bars.size()) - outcomes[0].length_scale->removed);
  EXPECT_EQ(b.design.n_components(), of_b);
  ASSERT_TRUE(outcomes[0].crisp.features);
  EXPECT_GT(outcomes[0].crisp.volume, outcomes[1].crisp.volume);
  EXPECT_LE(outcomes[0].crisp.volume + outcomes[1].crisp.volume, 1 + 1e-4);
}

/// Returns loads of three bodies.
std::vector<fem::EslSets> three(double swing) {
  return {turning_plate(2, swing), turning_plate(2), turning_plate(2)};
}

std::vector<BodyProblem> three_bodies() {
  std::vector<BodyProblem> out = {body("a"), body("b"), body("c")};
  out[1].shares_mass = false;
  return out;
}

// The first and the third body share mass, the second does not: rows come in groups, outcomes in
// the order of the bodies.
TEST(EslLoop, SolvesThoseTogetherThatShare) {
  std::vector<BodyProblem> problems = three_bodies();
  std::string order;
  LoopObserver observer;
  observer.iteration = [&](const IterationReport& r) {
    order += r.problem.body;
    return true;
  };
  LoopSettings settings;
  settings.design = settings_of("mma", 3);
  const auto outcome = esl_loop(
      problems, [](std::span<const fem::ScaleFactors>) { return CycleMotion{three(3)}; }, settings,
      observer);
  EXPECT_EQ(order, "acacacbbb");
  ASSERT_EQ(outcome.size(), 3u);
  EXPECT_EQ(outcome[0].body + outcome[1].body + outcome[2].body, "abc");

  // The run is stopped in the first group. The second body then has no outcome, therefore the
  // outcome of the third one is not returned either.
  problems = three_bodies();
  int rows = 0;
  observer.iteration = [&](const IterationReport&) { return ++rows < 3; };
  const auto stopped = esl_loop(
      problems, [](std::span<const fem::ScaleFactors>) { return CycleMotion{three(3)}; }, settings,
      observer);
  EXPECT_EQ(rows, 4);  // both rows of the iteration
  ASSERT_EQ(stopped.size(), 1u);
  EXPECT_EQ(stopped[0].body, "a");
}

// Three cycles: the table is complete after every verified cycle, design changes are those of the
// crisp designs, and the result is the cycle with the best motion.
TEST(EslLoop, CyclesMakeATable) {
  std::vector<BodyProblem> problems = {body("a"), body("b")};
  LoopSettings settings;
  settings.design = settings_of("mma", 12);
  settings.max_cycles = 3;
  settings.tolerance = 0;
  int calls = 0;
  std::vector<std::vector<VectorXd>> densities;  // for every motion and body
  const auto simulate = [&](std::span<const fem::ScaleFactors>) {
    auto& now = densities.emplace_back();
    for (const BodyProblem& p : problems) now.push_back(fractions_of(p, p.design.components()));
    const double swing = calls % 2 == 0 ? 1 : 3;  // no cycle has the loads of its own motion
    return CycleMotion{{turning_plate(2, swing), turning_plate(2, 2 * swing)},
                       std::vector<double>{9, 3, 1, 2}[static_cast<size_t>(calls++)]};
  };
  LoopObserver observer;
  std::vector<CycleVerdict> table;
  std::vector<int> best;
  observer.verdict = [&](std::span<const CycleVerdict> all) {
    table.assign(all.begin(), all.end());
    EXPECT_EQ(table.size(), best.size() + 1);
    for (const CycleVerdict& v : table)
      if (v.best) best.push_back(v.cycle);
  };
  std::vector<std::vector<BodyOutcome>> outcomes;
  observer.cycle = [&](int, std::span<const BodyOutcome> o) {
    outcomes.emplace_back(o.begin(), o.end());
  };
  const auto result = esl_loop(problems, simulate, settings, observer);
  EXPECT_EQ(calls, 4);
  ASSERT_EQ(table.size(), 3u);
  EXPECT_EQ(best, (std::vector<int>{1, 2, 2}));
  const double integrals[] = {3, 1, 2};
  for (size_t c = 0; c < 3; ++c) {
    EXPECT_EQ(table[c].cycle, static_cast<int>(c) + 1);
    EXPECT_EQ(table[c].measure, integrals[c]);
    ASSERT_EQ(table[c].bodies.size(), 2u);
    double sum = 0;
    for (size_t k = 0; k < 2; ++k) {
      const BodyVerdict& v = table[c].bodies[k];
      EXPECT_EQ(v.body, k == 0 ? "a" : "b");
      EXPECT_EQ(v.compliance, outcomes[c][k].compliance);
      EXPECT_EQ(v.crisp_compliance, outcomes[c][k].crisp.compliance);
      EXPECT_NEAR(v.design_change, (densities[c + 1][k] - densities[c][k]).cwiseAbs().mean(),
                  1e-14);
      EXPECT_GT(v.design_change, 0);
      EXPECT_LT(v.design_change, 1);
      sum += outcomes[c][k].compliance;
    }
    EXPECT_NEAR(table[c].objective, sum, 1e-14 * sum);
  }
  for (size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(result[k].compliance, outcomes[1][k].compliance);
    EXPECT_EQ(fractions_of(problems[k], problems[k].design.components()), densities[2][k]);
  }
}

}  // namespace
}  // namespace flexmorph::mmc::test
