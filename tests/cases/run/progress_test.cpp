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

TEST(TimeLeft, FollowsFromThePartThatIsDone) {
  EXPECT_TRUE(contains(time_left(10, 0.25), " 30 s "));
  EXPECT_TRUE(contains(time_left(3600, 0.5), " 60 min "));
  EXPECT_TRUE(contains(time_left(10, 1), " 0 s "));
  EXPECT_EQ(time_left(10, 0), "");     // nothing has been done yet
  EXPECT_EQ(time_left(0.1, 0.5), "");  // too short for an estimate
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
