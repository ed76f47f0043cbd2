// Shows when cycles of loads and designs end, and which design is delivered.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/optim/mmc_one_body.h"

namespace flexmorph::mmc::test {
namespace {

/// Returns loads of a motion whose strain energies are the static energies of a design, so that
/// there is no geometric difference. The loads of every second call have three times the bending
/// acceleration.
CycleMotion alternating(std::vector<BodyProblem>& problems, int call, double measure) {
  CycleMotion out{{turning_plate(2, call % 2 == 0 ? 1 : 3)}, measure};
  const CellScaleFactors crisp =
      ersatz_of(problems[0]).crisp(fractions_of(problems[0], problems[0].design.components()));
  const VectorXd each = ComplianceEvaluator(out.loads[0], kSection, {}, crisp.stiffness, crisp.mass)
                            .individual(crisp.stiffness, crisp.mass);
  for (size_t k = 0; k < out.loads[0].sets.size(); ++k)
    out.loads[0].sets[k].strain_energy = 0.5 * each[static_cast<Eigen::Index>(k)];
  return out;
}

// From the third motion on the loads do not change: the second cycle was made for the loads of its
// own motion, therefore no third cycle follows.
TEST(EslLoop, EndsWhenTheLoadsAreThoseOfTheMotion) {
  std::vector<BodyProblem> problems = one_body({1.5});
  problems[0].goal.limits[0].value = 0.9;  // of the volume: stiffer than uniform material
  LoopSettings settings = quick(30);
  settings.max_cycles = 12;
  settings.tolerance = 0;
  int calls = 0;
  const auto simulate = [&](std::span<const fem::ScaleFactors>) {
    const int call = calls++;
    return alternating(problems, call == 0 ? 0 : 1, 1.0 / calls);
  };
  std::vector<double> differences;
  LoopObserver observer;
  observer.difference = [&](int cycle, std::span<const LoadDifference> all) {
    ASSERT_EQ(all.size(), 1u);
    EXPECT_EQ(cycle, static_cast<int>(differences.size()) + 1);
    EXPECT_EQ(all[0].body, "plate");
    EXPECT_NEAR(all[0].geometric, 0, 1e-12);
    differences.push_back(all[0].loads);
  };
  std::vector<CyclesEnd> ends;
  observer.end = [&](CyclesEnd reason) { ends.push_back(reason); };
  esl_loop(problems, simulate, settings, observer);
  EXPECT_EQ(ends, std::vector{CyclesEnd::loads_agree});
  EXPECT_EQ(calls, 3);
  ASSERT_EQ(differences.size(), 2u);
  EXPECT_GT(differences[0], LoadDifference::kLargest);
  EXPECT_NEAR(differences[1], 0, 1e-9);
}

// The loads are those of the motion from the first cycle on, but cycles of three iterations first
// give designs that are more compliant than uniform material. Cycles continue until a design is
// stiffer.
TEST(EslLoop, GoesOnWhileTheDesignIsOfNoUse) {
  std::vector<BodyProblem> problems = one_body({1.5});
  problems[0].goal.limits[0].value = 0.9;  // of the volume: enough to connect load and support soon
  LoopSettings settings = quick(3);
  settings.max_cycles = 40;
  settings.tolerance = 0;
  int calls = 0;
  const auto simulate = [&](std::span<const fem::ScaleFactors>) {
    return alternating(problems, 0, 1.0 / ++calls);
  };
  std::vector<bool> worse;
  LoopObserver observer;
  observer.cycle = [&](int, std::span<const BodyOutcome> outcomes) {
    worse.push_back(outcomes[0].crisp.compliance > outcomes[0].uniform_compliance);
  };
  observer.difference = [&](int, std::span<const LoadDifference> all) {
    EXPECT_LT(all[0].loads, LoadDifference::kLargest);
  };
  esl_loop(problems, simulate, settings, observer);
  ASSERT_GT(worse.size(), 1u);
  EXPECT_LT(worse.size(), 40u);
  for (size_t k = 0; k + 1 < worse.size(); ++k) EXPECT_TRUE(worse[k]) << k;
  EXPECT_FALSE(worse.back());
}

// With tolerance 0, the motion after cycle 3 is worse than that after cycle 2, and no fourth cycle
// follows although the loads still differ. With tolerance 0.5, the cycle that improves the measure
// by less than the tolerance is the last one.
TEST(EslLoop, EndsWhenACycleDoesNotPay) {
  for (const double tolerance : {0.0, 0.5}) {
    std::vector<BodyProblem> problems = one_body({1.5});
    LoopSettings settings = quick(5);
    settings.max_cycles = 12;
    settings.tolerance = tolerance;
    std::vector<double> crisp;
    LoopObserver observer;
    observer.cycle = [&](int, std::span<const BodyOutcome> outcomes) {
      crisp.push_back(outcomes[0].crisp.compliance);
    };
    const double measure[] = {9, 3, 2, 2.5};
    int calls = 0;
    const auto simulate = [&](std::span<const fem::ScaleFactors>) {
      const int call = calls++;
      return alternating(problems, call, measure[call]);
    };
    std::vector<CycleVerdict> verdicts;
    observer.verdict = [&](std::span<const CycleVerdict> all) {
      verdicts.assign(all.begin(), all.end());
    };
    std::vector<CyclesEnd> ends;
    observer.end = [&](CyclesEnd reason) { ends.push_back(reason); };
    const auto outcome = esl_loop(problems, simulate, settings, observer);
    EXPECT_EQ(ends, std::vector{CyclesEnd::little_improvement});
    const size_t cycles = tolerance == 0 ? 3 : 2;
    EXPECT_EQ(calls, static_cast<int>(cycles) + 1);
    ASSERT_EQ(crisp.size(), cycles);
    ASSERT_EQ(verdicts.size(), cycles);
    for (const CycleVerdict& v : verdicts) {
      EXPECT_EQ(v.best, v.cycle == 2);
      EXPECT_EQ(v.measure, measure[v.cycle]);
    }
    EXPECT_EQ(outcome[0].crisp.compliance, crisp[1]);
    if (cycles == 3) {
      EXPECT_NE(crisp[1], crisp[2]);
    }
  }
}

// A design that violates its limit is worse than any design that satisfies it, whatever its motion.
TEST(EslLoop, DeliversTheBestUsableCycle) {
  std::vector<BodyProblem> problems = one_body({1.5});
  // only a support, therefore separate regions do not matter
  problems[0].locations = ends_of(kGrid);
  problems[0].locations.pop_back();
  LoopSettings settings = quick(5);
  settings.max_cycles = 3;
  settings.tolerance = 0;
  LoopObserver observer;
  // The first cycle may use the whole plate; the design of the second cycle exceeds its limit
  // tenfold.
  observer.cycle = [&](int cycle, std::span<const BodyOutcome>) {
    for (Limit& limit : problems[0].goal.limits) limit.value = cycle == 1 ? 1 : 0.05;
  };
  int calls = 0;
  const auto simulate = [&](std::span<const fem::ScaleFactors>) {
    const int call = calls++;
    return alternating(problems, call, 1.0 / calls);
  };
  std::vector<CycleVerdict> verdicts;
  observer.verdict = [&](std::span<const CycleVerdict> all) {
    verdicts.assign(all.begin(), all.end());
  };
  esl_loop(problems, simulate, settings, observer);
  ASSERT_EQ(verdicts.size(), 2u);
  EXPECT_EQ(verdicts[0].violation, 0);
  EXPECT_GT(verdicts[1].violation, 1);
  EXPECT_LT(verdicts[1].measure, verdicts[0].measure);
  EXPECT_TRUE(verdicts[0].best);
}

// If cycles are compared by a verification motion, the measure of the loads' motion is ignored, and
// the latter is not computed when no further cycle follows.
TEST(EslLoop, IsVerifiedByAnotherMotion) {
  std::vector<BodyProblem> problems = one_body({1.5});
  LoopSettings settings = quick(5);
  settings.max_cycles = 12;
  settings.tolerance = 0;
  const double integral[] = {3, 2, 2.5};
  int calls = 0, verified = 0;
  VectorXd seen;
  const auto simulate = [&](std::span<const fem::ScaleFactors> factors) {
    EXPECT_EQ(calls == 0, verified == 0);
    if (verified > 0) {
      EXPECT_EQ(factors[0].stiffness, seen);
    }
    const int call = calls++;
    return alternating(problems, call, calls);  // worse every time
  };
  settings.verification_motion = [&](std::span<const fem::ScaleFactors> factors) {
    seen = factors[0].stiffness;
    return integral[verified++];
  };
  std::vector<double> crisp;
  std::vector<CycleVerdict> verdicts;
  LoopObserver observer;
  observer.cycle = [&](int, std::span<const BodyOutcome> outcomes) {
    crisp.push_back(outcomes[0].crisp.compliance);
  };
  observer.verdict = [&](std::span<const CycleVerdict> all) {
    verdicts.assign(all.begin(), all.end());
  };
  const auto outcome = esl_loop(problems, simulate, settings, observer);
  EXPECT_EQ(calls, 3);
  EXPECT_EQ(verified, 3);
  ASSERT_EQ(verdicts.size(), 3u);
  for (size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(verdicts[k].measure, integral[k]);
    EXPECT_EQ(verdicts[k].best, k == 1);
  }
  EXPECT_EQ(outcome[0].crisp.compliance, crisp[1]);

  // A single cycle is not verified, because there is nothing to compare it with.
  settings.max_cycles = 1;
  problems = one_body({1.5});
  verified = calls = 0;
  esl_loop(problems, simulate, settings, {});
  EXPECT_EQ(verified, 0);

  // The second of two cycles is better, and its number ends the cycles.
  settings.max_cycles = 2;
  problems = one_body({1.5});
  verified = calls = 0;
  std::vector<CyclesEnd> ends;
  observer = {};
  observer.end = [&](CyclesEnd reason) { ends.push_back(reason); };
  esl_loop(problems, simulate, settings, observer);
  EXPECT_EQ(ends, std::vector{CyclesEnd::most_cycles});
}

}  // namespace
}  // namespace flexmorph::mmc::test
