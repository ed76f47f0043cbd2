// Cycles of loads and designs: when they end, and which one is delivered.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/optim/mmc_one_body.h"

namespace flexmorph::mmc::test {
namespace {

/// Loads of a motion whose strain energies are the static energies of a design, so that nothing of
/// them is geometry. Loads of every second call bend the plate three times as much.
CycleMotion alternating(std::vector<BodyProblem>& problems, int call, double measure) {
  CycleMotion out{{turning_plate(2, call % 2 == 0 ? 1 : 3)}, measure};
  const CellFactors sharp =
      ersatz_of(problems[0]).sharp(fractions_of(problems[0], problems[0].design.components()));
  const VectorXd each = ComplianceEvaluator(out.loads[0], kSection, {}, sharp.stiffness, sharp.mass)
                            .individual(sharp.stiffness, sharp.mass);
  for (size_t k = 0; k < out.loads[0].sets.size(); ++k)
    out.loads[0].sets[k].strain_energy = 0.5 * each[static_cast<Eigen::Index>(k)];
  return out;
}

// From the third motion on the loads no longer change: the second cycle was made for those of its
// own motion, and no third one follows.
TEST(EslLoop, EndsWhenTheLoadsAreThoseOfTheMotion) {
  std::vector<BodyProblem> problems = one_body({1.5});
  problems[0].goal.limits[0].value = 0.9;  // of the volume: stiffer than uniform material
  LoopSettings settings = quick(30);
  settings.max_cycles = 12;
  settings.tolerance = 0;
  int calls = 0;
  const auto simulate = [&](std::span<const fem::Factors>) {
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
  esl_loop(problems, simulate, settings, observer);
  EXPECT_EQ(calls, 3);
  ASSERT_EQ(differences.size(), 2u);
  EXPECT_GT(differences[0], LoadDifference::kLargest);
  EXPECT_NEAR(differences[1], 0, 1e-9);
}

// The loads are those of the motion from the first cycle on, but cycles of three iterations make
// designs that are more compliant than uniform material at first: cycles go on until one is not.
TEST(EslLoop, GoesOnWhileTheDesignIsOfNoUse) {
  std::vector<BodyProblem> problems = one_body({1.5});
  problems[0].goal.limits[0].value = 0.9;  // of the volume: enough to join load and support soon
  LoopSettings settings = quick(3);
  settings.max_cycles = 40;
  settings.tolerance = 0;
  int calls = 0;
  const auto simulate = [&](std::span<const fem::Factors>) {
    return alternating(problems, 0, 1.0 / ++calls);
  };
  std::vector<bool> worse;
  LoopObserver observer;
  observer.cycle = [&](int, std::span<const BodyOutcome> outcomes) {
    worse.push_back(outcomes[0].sharp.compliance > outcomes[0].uniform_compliance);
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

// The motion after cycle 3 is worse than the one after cycle 2: loads that still differ make no
// fourth one. Where a cycle improves the measure by less than the tolerance it is the last one.
TEST(EslLoop, EndsWhenACycleDoesNotPay) {
  for (const double tolerance : {0.0, 0.5}) {
    std::vector<BodyProblem> problems = one_body({1.5});
    LoopSettings settings = quick(5);
    settings.max_cycles = 12;
    settings.tolerance = tolerance;
    std::vector<double> sharp;
    LoopObserver observer;
    observer.cycle = [&](int, std::span<const BodyOutcome> outcomes) {
      sharp.push_back(outcomes[0].sharp.compliance);
    };
    const double measure[] = {9, 3, 2, 2.5};
    int calls = 0;
    const auto simulate = [&](std::span<const fem::Factors>) {
      const int call = calls++;
      return alternating(problems, call, measure[call]);
    };
    std::vector<CycleVerdict> verdicts;
    observer.verdict = [&](std::span<const CycleVerdict> all) {
      verdicts.assign(all.begin(), all.end());
    };
    const auto outcome = esl_loop(problems, simulate, settings, observer);
    const size_t cycles = tolerance == 0 ? 3 : 2;
    EXPECT_EQ(calls, static_cast<int>(cycles) + 1);
    ASSERT_EQ(sharp.size(), cycles);
    ASSERT_EQ(verdicts.size(), cycles);
    for (const CycleVerdict& v : verdicts) {
      EXPECT_EQ(v.best, v.cycle == 2);
      EXPECT_EQ(v.measure, measure[v.cycle]);
    }
    EXPECT_EQ(outcome[0].sharp.compliance, sharp[1]);
    if (cycles == 3) {
      EXPECT_NE(sharp[1], sharp[2]);
    }
  }
}

// A design beyond its limit is worse than any that keeps to it, whatever its motion.
TEST(EslLoop, DeliversTheBestUsableCycle) {
  std::vector<BodyProblem> problems = one_body({1.5});
  problems[0].places = ends_of(kGrid);  // of a support only: islands are no matter here
  problems[0].places.pop_back();
  LoopSettings settings = quick(5);
  settings.max_cycles = 3;
  settings.tolerance = 0;
  LoopObserver observer;
  // What the first cycle made may use the whole plate; what the second made is ten times too much.
  observer.cycle = [&](int cycle, std::span<const BodyOutcome>) {
    for (Limit& limit : problems[0].goal.limits) limit.value = cycle == 1 ? 1 : 0.05;
  };
  int calls = 0;
  const auto simulate = [&](std::span<const fem::Factors>) {
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

// Where another motion compares cycles, that of the loads has no say, and is not made where nothing
// follows.
TEST(EslLoop, IsVerifiedByAnotherMotion) {
  std::vector<BodyProblem> problems = one_body({1.5});
  LoopSettings settings = quick(5);
  settings.max_cycles = 12;
  settings.tolerance = 0;
  const double integral[] = {3, 2, 2.5};
  int calls = 0, verified = 0;
  VectorXd seen;
  const auto simulate = [&](std::span<const fem::Factors> factors) {
    EXPECT_EQ(calls == 0, verified == 0);
    if (verified > 0) {
      EXPECT_EQ(factors[0].stiffness, seen);
    }
    const int call = calls++;
    return alternating(problems, call, calls);  // ever worse
  };
  settings.verification_motion = [&](std::span<const fem::Factors> factors) {
    seen = factors[0].stiffness;
    return integral[verified++];
  };
  std::vector<double> sharp;
  std::vector<CycleVerdict> verdicts;
  LoopObserver observer;
  observer.cycle = [&](int, std::span<const BodyOutcome> outcomes) {
    sharp.push_back(outcomes[0].sharp.compliance);
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
  EXPECT_EQ(outcome[0].sharp.compliance, sharp[1]);

  // One cycle is not compared with any other.
  settings.max_cycles = 1;
  problems = one_body({1.5});
  verified = calls = 0;
  esl_loop(problems, simulate, settings, {});
  EXPECT_EQ(verified, 0);
}

}  // namespace
}  // namespace flexmorph::mmc::test
