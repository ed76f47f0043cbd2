// Shows that motions which are killed or interrupted continue from their checkpoint, and that the
// run then has the results of an undisturbed run byte for byte: motions alone, motions of cycles,
// and motions that assess a design.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <functional>
#include <thread>

#include "tests/cases/run/resumed.h"
#include "tests/support/errors.h"

namespace flexmorph::test {
namespace {

/// Waits until the motion with this checkpoint has begun; the name of the checkpoint is then in the
/// list of the folder. False if the run ended before.
bool has_begun(const std::string& folder, const std::string& checkpoint, const ChildProgram& run) {
  return eventually(run, [&] {
    const Words names = lines_of(contents_of(folder + "/.flexmorph"));
    return std::find(names.begin(), names.end(), checkpoint) != names.end();
  });
}

struct Disturbed {
  const char* name;
  std::string path;
  Words changes;
  std::string checkpoint;  ///< Checkpoint of the disturbed motion.
  int signal;              ///< SIGKILL is sent when the checkpoint exists, an interruption before.
};
void PrintTo(const Disturbed& d, std::ostream* out) { *out << d.name; }

class ResumedMotion : public ::testing::TestWithParam<Disturbed> {};

TEST_P(ResumedMotion, IsAsUndisturbed) {
  const Disturbed& d = GetParam();
  const Scratch scratch;
  const std::string whole = scratch / "whole", folder = scratch / "out";
  const Ended undisturbed = flexmorph(scratch, text_of(d.path, whole, d.changes));
  ASSERT_TRUE(is_done(undisturbed, whole));
  testing::ChildProgram run = start(scratch, text_of(d.path, folder, d.changes));
  const std::string checkpoint = folder + "/" + d.checkpoint;
  bool caught = has_begun(folder, d.checkpoint, run);
  ASSERT_TRUE(caught);
  if (d.signal == SIGKILL) caught = eventually(run, [&] { return fs::exists(checkpoint); });
  run.send(d.signal);
  if (!caught) {
    run.end();
    GTEST_SKIP() << "the motion took less than the second between two checkpoints";
  }
  EXPECT_EQ(run.end().code, d.signal == SIGKILL ? -1 : 4);
  expect_readable(folder);
  Words words = text_of(d.path, folder, d.changes, true);
  std::erase(words, "--quiet");
  const Ended ended = flexmorph(scratch, words);
  EXPECT_EQ(ended.code, undisturbed.code) << ended.err;
  EXPECT_TRUE(testing::mentions_all(ended.out, {"resumes", "t = "}));
  expect_same(lasting(folder), lasting(whole));
  EXPECT_FALSE(fs::exists(checkpoint));
}

INSTANTIATE_TEST_SUITE_P(
    Runs, ResumedMotion,
    ::testing::Values(
        Disturbed{"killed",
                  "plate_pendulum",
                  {"time.end=0.2", "time.step=5e-5"},
                  "motion.checkpoint",
                  SIGKILL},
        Disturbed{"interrupted", "deploying_plate", {"time.end=0.6"}, "motion.checkpoint", SIGTERM},
        Disturbed{"second_cycle",
                  FLEXMORPH_TWO_PLATES,
                  {"time.step=1e-4", "cycle.max_cycles=2", "optimizer.max_iterations=2"},
                  "motion_2.checkpoint",
                  SIGTERM},
        Disturbed{"outline_verification",
                  FLEXMORPH_SHORT_CASE,
                  {"time.step=2e-4", "optimizer.max_iterations=1", "design.cell=0.01",
                   "design.min_thickness=0.01", "esl.every=0.02"},
                  "motion.checkpoint",
                  SIGTERM}),
    [](const auto& info) { return std::string(info.param.name); });

// An unusable checkpoint is reported, and the motion starts from the beginning.
TEST(ResumeMotion, BeginsAnewWithADamagedCheckpoint) {
  const Scratch scratch;
  const std::string whole = scratch / "whole", folder = scratch / "out";
  const Words changes = {"time.end=0.6"};
  ASSERT_EQ(flexmorph(scratch, text_of("deploying_plate", whole, changes)).code, 0);
  testing::ChildProgram run = start(scratch, text_of("deploying_plate", folder, changes));
  ASSERT_TRUE(has_begun(folder, "motion.checkpoint", run));
  run.send(SIGTERM);
  ASSERT_EQ(run.end().code, 4);
  const std::string path = folder + "/motion.checkpoint";
  std::string text = contents_of(path);
  text[text.size() / 2] = static_cast<char>(text[text.size() / 2] ^ 4);
  std::ofstream(path, std::ios::binary | std::ios::trunc) << text;
  Words words = text_of("deploying_plate", folder, changes, true);
  std::erase(words, "--quiet");
  const Ended ended = flexmorph(scratch, words);
  EXPECT_EQ(ended.code, 0);
  EXPECT_TRUE(testing::mentions_all(ended.out, {"motion.checkpoint", "damaged"}));
  expect_same(lasting(folder), lasting(whole));
}

}  // namespace
}  // namespace flexmorph::test
