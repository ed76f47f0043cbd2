// The cycle dynamics -> loads -> design on a small plate whose "dynamics" is a formula: designs
// become feasible and stiffer, cycles end when the design rests, an observer can stop them, and
// the rows of the history describe the iterate they are shown with.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/optim/mmc_small.h"

namespace flexmorph::mmc::test {
namespace {

/// Ten cells across are too few to take half a cell off all around.
TdfSettings whole(double band) {
  TdfSettings settings = tdf_settings(band);
  settings.erosion = 0;
  return settings;
}

std::vector<BodyProblem> one_body(std::vector<double> bands = {2, 1}) {
  std::vector<TdfSettings> settings;
  for (const double band : bands) settings.push_back(whole(band));
  return {body_of(Design(kGrid, layout(), kScale), settings)};
}

LoopSettings quick(int iterations) {
  LoopSettings settings;
  settings.design.sharp_every = 7;
  settings.design.optimizer.max_iterations = iterations;
  return settings;
}

TEST(EslLoop, MakesAFeasibleStifferDesign) {
  std::vector<BodyProblem> problems = one_body();
  const VectorXd start = problems[0].design.x();
  int calls = 0;
  const auto simulate = [&](std::span<const fem::Factors> factors) {
    ++calls;
    EXPECT_EQ(factors.size(), 1u);
    EXPECT_EQ(factors[0].stiffness.size(), kGrid.n_cells());
    // The void factors of dynamics, not those of statics.
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
  // Bars beat the same volume spread evenly. (Of blurred ones only: half-thicknesses of 0.6 cells
  // are nothing a sharp picture on this mesh could show.)
  EXPECT_LT(o.compliance, 0.95 * o.uniform_compliance);
  EXPECT_GT((problems[0].design.x() - start).norm(), 0);
  EXPECT_EQ(o.iterations, 60);
  EXPECT_GE(o.evaluations, o.iterations);
  EXPECT_EQ(o.n_loads, 3);
  EXPECT_EQ(o.load_compliances.size(), 3u);
  EXPECT_EQ(o.energy_ratios.size(), 3u);

  // The sharp compliance is that of the loads together.
  double sum = 0;
  const fem::EslSets loads = turning_plate(3);
  for (size_t l = 0; l < 3; ++l) sum += loads.sets[l].weight * o.load_compliances[l];
  EXPECT_NEAR(sum, o.sharp.compliance, 1e-8 * sum);

  // And the outcome is that of the design left behind, computed afresh.
  const Ersatz ersatz(kGrid, 1e-3, problems[0].solid, {});
  ComplianceEvaluator compliance(loads, kSection, {}, {}, {});
  MmcProblem again({kPlate, problems[0].design, ersatz, compliance}, whole(1), least_compliance());
  again.evaluate(problems[0].design.x());
  EXPECT_NEAR(again.compliance(), o.compliance, 1e-12 * o.compliance);
  EXPECT_NEAR(again.volume(), o.volume, 1e-14);
}

TEST(EslLoop, ComparesWithTheSameVolumeSpreadEvenly) {
  std::vector<BodyProblem> problems = one_body();
  const auto simulate = [](std::span<const fem::Factors>) {
    return CycleMotion{{turning_plate(2)}};
  };
  const auto outcome = esl_loop(problems, simulate, quick(2), {});
  ComplianceEvaluator compliance(turning_plate(2), kSection, {}, {}, {});
  ComplianceEvaluator::Value value;
  const VectorXd half = VectorXd::Constant(kGrid.n_cells(), 0.5);
  compliance.evaluate(half, half, value);
  // Two systems are solved, the second one with half of the stiffness. Their condition number is
  // about 5 E t / λ: E t = 1e6 N/m is the membrane stiffness, λ = E I (1.875 / L)^4 L / n = 7 N/m
  // the least eigenvalue, that of the first bending mode (E I = 83 N m^2, L = 0.6 m, n = 671
  // nodes). A backward stable solution has a relative error of at most that times the machine
  // precision.
  const double condition = 5e6 / 7;
  EXPECT_NEAR(outcome[0].uniform_compliance, value.f,
              condition * std::numeric_limits<double>::epsilon() * value.f);
}

// Every row is about the iterate it comes with: state, compliance and sharp picture belong to x.
TEST(EslLoop, RowsDescribeTheirIterates) {
  for (const char* name : {"mma", "nlopt_mma", "ipopt"}) {
    std::vector<BodyProblem> problems = one_body();
    const fem::EslSets loads = turning_plate(3);
    const auto simulate = [&](std::span<const fem::Factors>) { return CycleMotion{{loads}}; };
    const Ersatz ersatz(kGrid, 1e-3, problems[0].solid, {});
    ComplianceEvaluator compliance(loads, kSection, {}, {}, {});
    int rows = 0, evaluations = 0, sharp = 0;
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
      EXPECT_EQ(r.sharp != nullptr, rows % 7 == 0);
      if (r.sharp) {
        ++sharp;
        EXPECT_NEAR(
            r.sharp->volume,
            area_fractions(kGrid, r.state.components(), kScale.min_thickness, problems[0].solid, {})
                .mean(),
            2e-3);  // 64 samples of a cell
        EXPECT_GT(r.sharp->compliance, 0);
      }
      return true;
    };
    LoopSettings settings = quick(16);
    settings.design.optimizer.name = name;
    const auto outcome = esl_loop(problems, simulate, settings, observer);
    EXPECT_EQ(outcome[0].iterations, rows) << name;
    EXPECT_EQ(sharp, rows / 7) << name;
    EXPECT_GE(outcome[0].evaluations, evaluations) << name;
  }
}

TEST(EslLoop, EveryStageHasItsBandAndItsShare) {
  std::vector<BodyProblem> problems = one_body({3, 2, 1});
  const auto simulate = [](std::span<const fem::Factors>) {
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

// What comes of the best of several starts is what comes of that start alone.
TEST(EslLoop, TakesTheBestOfItsStarts) {
  const auto simulate = [](std::span<const fem::Factors>) {
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
    EXPECT_EQ(found.sharp.compliance, alone[best].sharp.compliance);
    EXPECT_EQ(found.iterations, 60);
    ASSERT_EQ(bands.size(), 60U);
    for (size_t k = 0; k < bands.size(); ++k) EXPECT_EQ(bands[k], k % 20 < 10 ? 2 : 1) << k;
  }
}

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

// Loads of half the energy, with and without a motion that is stiffer by half as its deflections
// are large: w |U_s - U| / w U by hand.
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
  // Where the motion passes through rest there is no secant: energies are compared as they are.
  motion[0].strain_energy = 0;
  EXPECT_NEAR(load_difference(made_for, own, motion).loads,
              (0.5 + 3 * (4 / 3.0) * 0.5) / (3 * 4 / 3.0), 1e-14);
  EXPECT_THROW(load_difference({made_for, 1}, own, motion), Error);
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

TEST(EslLoop, StopsWhenTheObserverSaysSo) {
  std::vector<BodyProblem> problems = one_body();
  problems.push_back(problems[0]);
  problems[1].body = "other";
  LoopSettings settings = quick(20);
  settings.max_cycles = 5;
  int rows = 0, cycles = 0, calls = 0;
  const auto simulate = [&](std::span<const fem::Factors> factors) {
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
  EXPECT_TRUE(outcome[0].stop.starts_with("interrupted after ")) << outcome[0].stop;
  EXPECT_GT(outcome[0].sharp.compliance, 0);
}

TEST(EslLoop, DynamicsThatFailEndIt) {
  std::vector<BodyProblem> problems = one_body();
  const VectorXd start = problems[0].design.x();
  LoopSettings settings = quick(3);
  settings.max_cycles = 3;
  settings.tolerance = 0;
  int rows = 0, calls = 0;
  const auto simulate = [&](std::span<const fem::Factors>) -> CycleMotion {
    if (++calls == 2) throw Error::numerical("no convergence");
    return {{turning_plate(2)}};
  };
  LoopObserver observer;
  observer.iteration = [&](const IterationReport&) { return ++rows > 0; };
  EXPECT_THROW(esl_loop(problems, simulate, settings, observer), Error);
  EXPECT_EQ(rows, 3);
  EXPECT_GT((problems[0].design.x() - start).norm(), 0);  // what the first cycle found stands
}

}  // namespace
}  // namespace flexmorph::mmc::test
