// Shows that a run reports its progress, and which data about a failure it leaves.
#include "cases/run/progress.h"

#include <gtest/gtest.h>

#include "tests/cases/program.h"
#include "tests/cases/run_json.h"
#include "tests/support/errors.h"

namespace flexmorph::cases {
namespace {

using nlohmann::json;
using test::Ended;
using test::Words;

TEST(LeftText, ShowsARangeOrOneNumber) {
  EXPECT_TRUE(contains(left_text({30, 32}), " 31 s "));
  EXPECT_TRUE(contains(left_text({3600, 3600}), " 60 min "));
  EXPECT_TRUE(contains(left_text({10, 25}), " 10 to 25 s "));
  EXPECT_TRUE(contains(left_text({40, 600}), " 40 s to 10 min "));
  EXPECT_EQ(left_text({0, 0}), "");  // nothing is known
}

/// The phases of a run with two permitted cycles: 2 s of motion, in every cycle 10 s of design and
/// 2 s of motion, and two final motions of 4 s that may run at the same time.
std::vector<PhaseCost> two_cycles() {
  const PhaseCost motion{.name = "motion", .kind = "motion", .seconds = 2};
  std::vector<PhaseCost> out = {motion};
  for (const int cycle : {1, 2}) {
    out.push_back({"design", "design", cycle, 10, true});
    out.push_back({"motion", "motion", cycle, 2});
  }
  out.push_back({"motion with the design", "motion", 0, 4, false, 1});
  out.push_back({"motion with uniform material", "motion", 0, 4, false, 1});
  return out;
}

void expect_within(const SecondsRange& range, double seconds) {
  EXPECT_LT(range.least, seconds);
  EXPECT_GT(range.most, seconds);
}

// A machine that is three times as slow as expected, and a second cycle that is not needed. The
// true time that is left lies in every range.
TEST(WorkPlan, LearnsTheSpeedOfThisMachine) {
  WorkPlan plan(two_cycles(), {}, 1);
  plan.begin("motion", 0);
  plan.advance("motion", 0.5, {0.5, 0.5}, 3);
  plan.advance("design", 1, {65, 99}, 6);
  // 21 s of design, 6 s of motion and 24 s of final motions follow, and perhaps a cycle of 36 s.
  plan.advance("design", 30, {45.5, 70}, 15);
  expect_within(plan.left(15), 21 + 6 + 24);
  EXPECT_LT(plan.left(15).most, 3 * 66);
  plan.advance("design", 90, {6.5, 10}, 33);
  plan.begin("motion", 36);
  // The first cycle ends with this motion. The range begins with the final motions alone.
  expect_within(plan.left(36), 6 + 24);
  plan.begin("motion with the design", 42);  // the loads agree: no second cycle
  expect_within(plan.left(42), 24);
  EXPECT_LT(plan.left(42).most, 24 + 30);  // no cycle is open
  plan.advance("motion with the design", 0.5, {0.5, 0.5}, 48);
  plan.advance("motion with the design", 1, {0, 0}, 54);
  plan.advance("motion with uniform material", 0.01, {0.99, 0.99}, 54);
  plan.advance("motion with uniform material", 0.5, {0.5, 0.5}, 60);
  expect_within(plan.left(60), 6);
  // From the half of a phase on, its end is known within a factor of 1.1 to both sides.
  EXPECT_LE(6 + plan.left(60).most, 1.2101 * (6 + plan.left(60).least));
  EXPECT_NEAR(plan.completed(60), 0.9, 0.02);
}

// One kind of phases takes ten times as long as expected: other kinds are not expected to.
TEST(WorkPlan, KindsOfPhasesHaveSpeedsOfTheirOwn) {
  WorkPlan plan({{"motion", "motion", 0, 2},
                 {"outlines", "outlines", 0, 10},
                 {"last motion", "motion", 0, 4}},
                {}, 1);
  plan.begin("motion", 0);
  plan.begin("outlines", 20);
  expect_within(plan.left(20), 10 + 40);
  EXPECT_LT(plan.left(20).most, 2 * 50);
  plan.begin("last motion", 30);
  expect_within(plan.left(30), 40);
}

// Iterations with constraints on widths cost five times as much, and half of the other iterations
// were not needed: the plan counts costs, not iterations.
TEST(WorkPlan, CountsTheCostOfIterations) {
  std::vector<PhaseCost> design = {
      {.name = "design", .kind = "design", .seconds = 14, .may_end_early = true}};
  WorkPlan plan(design, {{"plate", 0.1, 0.5}}, 1);
  plan.iterate("plate", {1, 0, 59, 20}, 0.1);
  plan.iterate("plate", {20, 0, 40, 20}, 2);  // 2 s of plain and 10 s of costly iterations follow
  SecondsRange left = plan.left(2);
  EXPECT_LT(left.least, 12);
  EXPECT_GT(left.most, 12);
  plan.iterate("plate", {30, 10, 10, 10}, 7);  // the plain ones ended early
  left = plan.left(7);
  EXPECT_LT(left.least, 5);
  EXPECT_GT(left.most, 5);
  EXPECT_LT(left.most, 2.5 * left.least);
}

// Without any progress the range contains the expected time of one cycle, which is enough for most
// cases, and is not wider than a factor of three.
TEST(WorkPlan, KnowsLittleAtTheStart) {
  const WorkPlan plan(two_cycles(), {}, 2);
  const SecondsRange left = plan.left(0);
  EXPECT_LT(left.least, 0.65 * (2 + 10 + 2 + 4));
  EXPECT_GT(left.most, 1.3 * (2 + 10 + 2 + 4));
  EXPECT_LE(left.most, 3.0001 * left.least);
  EXPECT_EQ(plan.completed(0), 0);
  EXPECT_EQ(WorkPlan().left(5).most, 0);
}

TEST(FailureOf, KnowsWhatTheErrorKnows) {
  Failure here;
  here.phase = "design";
  here.iteration = 7;
  const Failure told = failure_of(Error::numerical("singular"), here);
  EXPECT_EQ(told.phase, "design");
  EXPECT_EQ(told.iteration, 7);
  EXPECT_EQ(told.kind, "numerical");
  EXPECT_EQ(told.cause, "singular");
  Failure motion;
  motion.phase = "verification";
  motion.time = 0.25;
  const Failure own = failure_of(FailedRun(Error::numerical("no convergence"), motion), here);
  EXPECT_EQ(own.phase, "verification");
  EXPECT_EQ(own.time, 0.25);
  EXPECT_FALSE(own.iteration.has_value());
  EXPECT_EQ(failure_of(std::bad_alloc(), here).kind, "defect");
}

TEST(ProgressLines, SayPhaseAndHowManyOfHowMany) {
  const Scratch scratch;
  const std::string out = scratch / "out";
  const Ended ended = test::flexmorph(scratch, test::short_run(out, {"output.vtk=false"}));
  EXPECT_TRUE(test::is_done(ended, out));
  // The number of iterations covers both stages.
  EXPECT_TRUE(testing::mentions_all(
      ended.out, {"design", "plate", "cycle 1", "iteration 1 ", " 6", "KKT residual"}));
  // without a terminal only few lines are printed
  EXPECT_LT(test::lines_of(ended.out).size(), 20u);
  const json run = test::run_json(out);
  EXPECT_FALSE(run.contains("failure"));
  EXPECT_TRUE(testing::mentions_all(run["results"][0]["scaled_objective"],
                                    {"logarithm", "compliance", "[J]"}));
}

// Two numerical failures: a path that cannot pass its limit point within the given number of
// equilibria, and a motion whose steps are far too long for its loading. Both are described by data
// in run.json.
TEST(Failures, AreDataInRunJson) {
  struct Row {
    Words words;
    const char *phase, *location;
  };
  for (const Row& row : std::vector<Row>{
           {{"beam_heated_held", "--set", "static.max_steps=5"}, "statics", "load_factor"},
           {{"rotating_plate_v05", "--set", "hub.angular_velocity=2000", "--set",
             "design=", "--set", "esl=", "--set", "optimizer=", "--set", "cycle=", "--set",
             "verify=", "--set", "accuracy=", "--set", "body.youngs_modulus=1e4"},
            "motion",
            "time"}}) {
    const Scratch scratch;
    const std::string out = scratch / "out";
    Words words = {"run", row.words[0], "-o", out, "--set", "expect="};
    words.insert(words.end(), row.words.begin() + 1, row.words.end());
    const Ended ended = test::flexmorph(scratch, words);
    ASSERT_EQ(ended.code, 3) << ended.out << ended.err;
    const json run = test::run_json(out);
    ASSERT_TRUE(run.contains("failure"));
    const json& failure = run["failure"];
    EXPECT_EQ(failure["phase"], row.phase);
    EXPECT_TRUE(failure[row.location].is_number()) << failure;
    EXPECT_EQ(failure["kind"], "numerical");
    EXPECT_TRUE(contains(ended.err, failure["cause"].get<std::string>()));
  }
}

}  // namespace
}  // namespace flexmorph::cases
