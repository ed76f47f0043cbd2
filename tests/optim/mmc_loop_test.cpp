// Shows that the cycle dynamics -> loads -> design works on a small plate whose "dynamics" is a
// formula: designs become feasible and stiffer, cycles end when the design stagnates, an observer
// can stop them, and rows of the history describe their own iterate.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/optim/mmc_one_body.h"

namespace flexmorph::mmc::test {
namespace {

TEST(EslLoop, MakesAFeasibleStifferDesign) {
  std::vector<BodyProblem> problems = one_body();
  const VectorXd start = problems[0].design.x();
  int calls = 0;
  const auto simulate = [&](std::span<const fem::ScaleFactors> factors) {
    ++calls;
    EXPECT_EQ(factors.size(), 1u);
    EXPECT_EQ(factors[0].stiffness.size(), kGrid.n_cells());
    // The void factors are those of dynamics, not those of statics.
    EXPECT_NEAR(factors[0].stiffness.minCoeff(), 1e-4, 1e-15);
    EXPECT_NEAR(factors[0].mass.minCoeff(), 1e-3, 1e-15);
    return CycleMotion{{turning_plate(3)}};
  };
  double first = 0, last = 0;
  LoopObserver observer;
  observer.iteration = [&](const IterationReport& r) {
    if (r.iteration == 1) first = r.state.compliance();
    last = r.state.compliance();
    return true;
  };
  const auto outcome = esl_loop(problems, simulate, quick(60), observer);
  ASSERT_EQ(outcome.size(), 1u);
  const BodyOutcome& o = outcome[0];
  EXPECT_EQ(calls, 1);
  EXPECT_EQ(o.body, "plate");
  EXPECT_LE(o.volume, 0.5 * (1 + 1e-4));
  EXPECT_LT(o.compliance, 0.9 * first);
  EXPECT_LT(last, first);
  // Bars are stiffer than uniformly distributed material of equal volume. (Only smoothed designs
  // are compared, because half-thicknesses of 0.6 cells cannot be represented by crisp designs on
  // this mesh.)
  EXPECT_LT(o.compliance, o.uniform_compliance);
  EXPECT_GT((problems[0].design.x() - start).norm(), 0);
  EXPECT_EQ(o.iterations, 60);
  EXPECT_GE(o.evaluations, o.iterations);
  EXPECT_EQ(o.n_loads, 3);
  EXPECT_EQ(o.load_compliances.size(), 3u);
  EXPECT_EQ(o.energy_ratios.size(), 3u);

  // The crisp compliance is the weighted sum over all loads.
  double sum = 0;
  const fem::EslSets loads = turning_plate(3);
  for (size_t l = 0; l < 3; ++l) sum += loads.sets[l].weight * o.load_compliances[l];
  EXPECT_NEAR(sum, o.crisp.compliance, 1e-8 * sum);

  // The outcome agrees with a new evaluation of the final design.
  const Ersatz ersatz(kGrid, 1e-3, problems[0].solid, {});
  ComplianceEvaluator compliance(loads, kSection, {}, {}, {});
  MmcProblem again({kPlate, problems[0].design, ersatz, compliance}, whole(1), least_compliance());
  again.evaluate(problems[0].design.x());
  EXPECT_NEAR(again.compliance(), o.compliance, 1e-12 * o.compliance);
  EXPECT_NEAR(again.volume(), o.volume, 1e-14);
}

TEST(EslLoop, ComparesWithTheSameVolumeSpreadEvenly) {
  std::vector<BodyProblem> problems = one_body();
  const auto simulate = [](std::span<const fem::ScaleFactors>) {
    return CycleMotion{{turning_plate(2)}};
  };
  const auto outcome = esl_loop(problems, simulate, quick(2), {});
  ComplianceEvaluator compliance(turning_plate(2), kSection, {}, {}, {});
  ComplianceEvaluator::Value value;
  const VectorXd half = VectorXd::Constant(kGrid.n_cells(), 0.5);
  compliance.evaluate(half, half, value);
  // Two systems are solved, the second one with half of the stiffness. Their condition number is
  // about 5 E t / λ: E t = 1e6 N/m is the membrane stiffness, λ = E I (1.875 / L)^4 L / n = 7 N/m
  // is the smallest eigenvalue, that of the first bending mode (E I = 83 N m^2, L = 0.6 m, n = 671
  // nodes). A backward stable solution has a relative error of at most the condition number times
  // the machine precision.
  const double condition = 5e6 / 7;
  EXPECT_NEAR(outcome[0].uniform_compliance, value.f,
              condition * std::numeric_limits<double>::epsilon() * value.f);
}

// Every row describes its own iterate: state, compliance and crisp design belong to x.
TEST(EslLoop, RowsDescribeTheirIterates) {
  for (const char* name : {"mma", "nlopt_mma", "ipopt"}) {
    std::vector<BodyProblem> problems = one_body();
    const fem::EslSets loads = turning_plate(3);
    const auto simulate = [&](std::span<const fem::ScaleFactors>) { return CycleMotion{{loads}}; };
    const Ersatz ersatz(kGrid, 1e-3, problems[0].solid, {});
    ComplianceEvaluator compliance(loads, kSection, {}, {}, {});
    int rows = 0, evaluations = 0, crisp = 0;
    LoopObserver observer;
    observer.iteration = [&](const IterationReport& r) {
      EXPECT_EQ(r.iteration, ++rows);
      EXPECT_GE(r.evaluations, evaluations);
      evaluations = r.evaluations;
      EXPECT_EQ(r.state.x(), *r.iterate.x);
      EXPECT_NEAR(std::log(r.state.compliance()), r.iterate.response->f, 1e-12);
      EXPECT_EQ(&r.value, &r.state.value());
      EXPECT_NEAR(r.iterate.violation, std::max(0.0, r.state.volume() / 0.5 - 1), 1e-12);
      const Design design(kGrid, r.state.components(), kScale);
      MmcProblem again({kPlate, design, ersatz, compliance}, whole(r.state.band() / kGrid.dx()),
                       least_compliance());
      again.evaluate(design.x());
      EXPECT_NEAR(again.compliance(), r.state.compliance(), 1e-9 * again.compliance()) << name;
      EXPECT_EQ(r.crisp != nullptr, rows % 7 == 0);
      if (r.crisp) {
        ++crisp;
        EXPECT_NEAR(
            r.crisp->volume,
            area_fractions(kGrid, r.state.components(), kScale.min_thickness, problems[0].solid, {})
                .mean(),
            2e-3);  // 64 samples per cell
        EXPECT_GT(r.crisp->compliance, 0);
      }
      return true;
    };
    LoopSettings settings = quick(16);
    settings.design.optimizer.name = name;
    const auto outcome = esl_loop(problems, simulate, settings, observer);
    EXPECT_EQ(outcome[0].iterations, rows) << name;
    EXPECT_EQ(crisp, rows / 7) << name;
    EXPECT_GE(outcome[0].evaluations, evaluations) << name;
  }
}

TEST(EslLoop, EveryStageHasItsBandAndItsShare) {
  std::vector<BodyProblem> problems = one_body({3, 2, 1});
  const auto simulate = [](std::span<const fem::ScaleFactors>) {
    return CycleMotion{{turning_plate(2)}};
  };
  std::vector<int> per_band(4, 0);
  LoopObserver observer;
  observer.iteration = [&](const IterationReport& r) {
    ++per_band[static_cast<size_t>(std::lround(r.state.band() / kGrid.dx()))];
    return true;
  };
  esl_loop(problems, simulate, quick(10), observer);
  EXPECT_EQ(per_band, (std::vector<int>{0, 4, 3, 3}));
}

// The outcome of several starts is exactly the outcome of the best start alone.
TEST(EslLoop, TakesTheBestOfItsStarts) {
  const auto simulate = [](std::span<const fem::ScaleFactors>) {
    return CycleMotion{{turning_plate(2)}};
  };
  std::vector<int> bands;
  LoopObserver observer;
  observer.iteration = [&](const IterationReport& r) {
    bands.push_back(static_cast<int>(std::lround(r.state.band() / kGrid.dx())));
    return true;
  };
  const std::vector<Design> starts = {Design(kGrid, random_layout(1, 2), kScale),
                                      Design(kGrid, layout(), kScale),
                                      Design(kGrid, random_layout(3, 2), kScale)};
  std::vector<BodyOutcome> alone;
  for (const Design& start : starts) {
    std::vector<BodyProblem> problems = one_body();
    problems[0].design = start;
    alone.push_back(esl_loop(problems, simulate, quick(20), {})[0]);
  }
  size_t best = 0;
  for (size_t k = 1; k < alone.size(); ++k)
    if (alone[k].compliance < alone[best].compliance) best = k;
  for (const size_t first : {size_t(0), size_t(1), size_t(2)}) {
    std::vector<BodyProblem> problems = one_body();
    problems[0].design = starts[first];
    problems[0].further_starts = {starts[(first + 1) % 3], starts[(first + 2) % 3]};
    bands.clear();
    const BodyOutcome found = esl_loop(problems, simulate, quick(20), observer)[0];
    EXPECT_EQ(static_cast<size_t>(found.start), (best + 3 - first) % 3 + 1);
    EXPECT_EQ(found.compliance, alone[best].compliance);
    EXPECT_EQ(found.crisp.compliance, alone[best].crisp.compliance);
    EXPECT_EQ(found.iterations, 60);
    ASSERT_EQ(bands.size(), 60U);
    for (size_t k = 0; k < bands.size(); ++k) EXPECT_EQ(bands[k], k % 20 < 10 ? 2 : 1) << k;
  }
}

// Loads of half the energy, with and without a motion that is stiffer by half because of large
// deflections. Reference: w |U_s - U| / w U computed by hand.
TEST(LoadDifference, IsWhatTheSecantStiffnessLeaves) {
  std::vector<fem::EslSet> motion(2);
  motion[0].weight = 1;
  motion[1].weight = 3;
  const double own[] = {2, 4}, made_for[] = {1, 6};
  for (const double stiffer : {1.0, 1.5}) {
    for (size_t k = 0; k < 2; ++k) motion[k].strain_energy = 0.5 * own[k] / stiffer;
    const LoadDifference found = load_difference(made_for, own, motion);
    EXPECT_NEAR(found.loads, (1 * 0.5 + 3 * 1) / (1 * 1 + 3 * 2.0), 1e-14);
    EXPECT_NEAR(found.geometric, stiffer - 1, 1e-14);
  }
  // If the motion has zero strain energy at a load, there is no secant stiffness; the energies are
  // then compared directly.
  motion[0].strain_energy = 0;
  EXPECT_NEAR(load_difference(made_for, own, motion).loads,
              (0.5 + 3 * (4 / 3.0) * 0.5) / (3 * 4 / 3.0), 1e-14);
  EXPECT_THROW(load_difference({made_for, 1}, own, motion), Error);
}

TEST(EslLoop, StopsWhenTheObserverSaysSo) {
  std::vector<BodyProblem> problems = one_body();
  problems.push_back(problems[0]);
  problems[1].body = "other";
  LoopSettings settings = quick(20);
  settings.max_cycles = 5;
  int rows = 0, cycles = 0, calls = 0;
  const auto simulate = [&](std::span<const fem::ScaleFactors> factors) {
    ++calls;
    EXPECT_EQ(factors.size(), 2u);
    return CycleMotion{{turning_plate(2), turning_plate(2)}};
  };
  LoopObserver observer;
  observer.iteration = [&](const IterationReport&) { return ++rows < 5; };
  observer.cycle = [&](int, std::span<const BodyOutcome> outcomes) {
    ++cycles;
    EXPECT_EQ(outcomes.size(), 1u);
  };
  const auto outcome = esl_loop(problems, simulate, settings, observer);
  EXPECT_EQ(rows, 5);
  EXPECT_EQ(calls, 1);
  EXPECT_EQ(cycles, 1);
  ASSERT_EQ(outcome.size(), 1u);
  EXPECT_EQ(outcome[0].iterations, 5);
  for (const char* part : {"interrupted", "5 iterations"})
    EXPECT_NE(outcome[0].stop.find(part), std::string::npos) << outcome[0].stop;
  EXPECT_GT(outcome[0].crisp.compliance, 0);
}

TEST(EslLoop, DynamicsThatFailEndIt) {
  std::vector<BodyProblem> problems = one_body();
  const VectorXd start = problems[0].design.x();
  LoopSettings settings = quick(3);
  settings.max_cycles = 3;
  settings.tolerance = 0;
  int rows = 0, calls = 0;
  const auto simulate = [&](std::span<const fem::ScaleFactors>) -> CycleMotion {
    if (++calls == 2) throw Error::numerical("no convergence");
    return {{turning_plate(2)}};
  };
  LoopObserver observer;
  observer.iteration = [&](const IterationReport&) { return ++rows > 0; };
  EXPECT_THROW(esl_loop(problems, simulate, settings, observer), Error);
  EXPECT_EQ(rows, 3);
  EXPECT_GT((problems[0].design.x() - start).norm(), 0);  // the result of the first cycle is kept
}

}  // namespace
}  // namespace flexmorph::mmc::test
