// Shows that runs which are killed and resumed have the results of an undisturbed run byte for
// byte.
#include <sys/resource.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "io/files.h"
#include "tests/cases/run/resumed.h"
#include "tests/cases/run_json.h"
#include "tests/support/errors.h"

namespace flexmorph::test {
namespace {

/// Waits until a history has more than n lines; false if the run ended before.
bool has_rows(const std::string& folder, size_t n, const ChildProgram& run) {
  return eventually(run, [&] { return lines_of(contents_of(folder + "/history.csv")).size() > n; });
}

/// Returns changes for the short case on coarse cells.
Words coarse(int iterations) {
  return {"optimizer.max_iterations=" + std::to_string(iterations), "design.cell=0.01",
          "design.min_thickness=0.01", "esl.every=0.02"};
}

struct Design {
  const char* name;
  std::string path;
  Words changes;
  /// Numbers of rows after which the run is killed, one after the other.
  std::vector<size_t> rows;
  size_t all;  ///< Number of rows of the complete history.
};
void PrintTo(const Design& d, std::ostream* out) { *out << d.name; }

class Resumed : public ::testing::TestWithParam<Design> {};

TEST_P(Resumed, IsAsUndisturbed) {
  const Design& d = GetParam();
  const Scratch scratch;
  const std::string whole = scratch / "whole", folder = scratch / "out";
  const Ended undisturbed = flexmorph(scratch, text_of(d.path, whole, d.changes));
  ASSERT_TRUE(is_done(undisturbed, whole));
  EXPECT_FALSE(fs::exists(whole + "/evaluations.log"));
  for (const size_t rows : d.rows) {
    testing::ChildProgram run = start(scratch, text_of(d.path, folder, d.changes, true));
    if (has_rows(folder, rows, run)) run.send(SIGKILL);
    run.end();
  }
  const Ended ended = flexmorph(scratch, text_of(d.path, folder, d.changes, true));
  EXPECT_EQ(ended.code, undisturbed.code) << ended.err;
  EXPECT_EQ(io::read_csv(folder + "/history.csv").n_rows(), d.all);
  expect_same(lasting(folder), lasting(whole));
  EXPECT_FALSE(fs::exists(folder + ".previous"));
}

INSTANTIATE_TEST_SUITE_P(
    Designs, Resumed,
    ::testing::Values(Design{"mma", FLEXMORPH_SHORT_CASE, coarse(30), {1, 7, 8, 29}, 30},
                      Design{"gcmma", FLEXMORPH_SHORT_CASE, {"optimizer.name=gcmma"}, {2, 5}, 6},
                      Design{"two_bodies_three_cycles",
                             FLEXMORPH_TWO_PLATES,
                             {"output.fields_every=4"},
                             {3, 14, 23},
                             30},
                      Design{"components_that_go",
                             "short_beam",
                             {"optimizer.max_iterations=40", "design.cell=0.05",
                              "design.min_feature=0.06", "output.design_every=3",
                              "output.fields_every=9", "output.plots=false"},
                             {10, 26, 33},
                             40}),
    [](const auto& info) { return std::string(info.param.name); });

// An interrupted run leaves complete files of what was computed; resuming it does not change the
// result.
TEST(Resume, GoesOnAfterAnInterruption) {
  const Scratch scratch;
  const std::string whole = scratch / "whole", folder = scratch / "out";
  const Words changes = coarse(30);
  flexmorph(scratch, text_of(FLEXMORPH_SHORT_CASE, whole, changes));
  testing::ChildProgram run = start(scratch, text_of(FLEXMORPH_SHORT_CASE, folder, changes));
  ASSERT_TRUE(has_rows(folder, 4, run));
  run.send(SIGTERM);
  ASSERT_EQ(run.end().code, 4);
  EXPECT_TRUE(fs::exists(folder + "/components.csv"));
  flexmorph(scratch, text_of(FLEXMORPH_SHORT_CASE, folder, changes, true));
  expect_same(lasting(folder), lasting(whole));
}

/// Returns the CPU time of all processes that this one has started and waited for [s].
double cpu_of_children() {
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

// The CPU time of a run is that of all its calls, as the system measures them. A call that is
// killed counts until a moment before it is killed; its time without a report of progress is not
// counted.
TEST(Resume, AddsTheTimesOfItsCalls) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const Words changes = coarse(30), words = text_of(FLEXMORPH_SHORT_CASE, folder, changes, true);
  const double before = cpu_of_children();
  double counted = 0;
  for (const int signal : {SIGTERM, SIGKILL}) {
    testing::ChildProgram run = start(scratch, words);
    ASSERT_TRUE(has_rows(folder, signal == SIGTERM ? 4 : 14, run));
    run.send(signal);
    run.end();
    const json times =
        json::parse(contents_of(folder + (signal == SIGTERM ? "/run.json" : "/times.checkpoint")));
    EXPECT_GT(times["seconds_cpu"].get<double>(), counted);
    counted = times["seconds_cpu"].get<double>();
  }
  const double spent = cpu_of_children() - before;
  EXPECT_LE(counted, spent);
  flexmorph(scratch, words);
  const json run = run_json(folder);
  const double all = run["seconds_cpu"].get<double>();
  EXPECT_GT(all, counted);
  EXPECT_LE(all, cpu_of_children() - before);
  // What is not counted is the time of the killed call after its last report, and the end of calls.
  EXPECT_GE(all - counted, 0.5 * (cpu_of_children() - before - spent));
  double phases = 0;
  for (const json& seconds : run["seconds_by_phase"]) phases += seconds.get<double>();
  EXPECT_GT(phases, 0);
  EXPECT_FALSE(fs::exists(folder + "/times.checkpoint"));
}

TEST(Resume, RefusesAnotherCase) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  testing::ChildProgram run =
      start(scratch, text_of(FLEXMORPH_SHORT_CASE, folder, {"optimizer.max_iterations=300"}));
  ASSERT_TRUE(has_rows(folder, 2, run));
  run.send(SIGKILL);
  run.end();
  const std::string before = contents_of(folder + "/history.csv");
  const Ended ended = flexmorph(
      scratch, text_of(FLEXMORPH_SHORT_CASE, folder, {"optimizer.max_iterations=301"}, true));
  EXPECT_EQ(ended.code, 2);
  EXPECT_TRUE(testing::mentions_all(ended.err, {"'" + folder + "'", "another case", "--resume"}));
  EXPECT_EQ(contents_of(folder + "/history.csv"), before);
}

// Without its log a run solves every iteration again, and rewrites the earlier rows.
TEST(Resume, HasEveryRowOnceWithoutItsLog) {
  const Scratch scratch;
  const std::string whole = scratch / "whole", folder = scratch / "out";
  const int code = flexmorph(scratch, text_of(FLEXMORPH_SHORT_CASE, whole, {})).code;
  fs::copy(whole, folder, fs::copy_options::recursive);
  json run = run_json(folder);
  run["status"] = "running";
  io::write_file(folder + "/run.json", run.dump());
  EXPECT_EQ(flexmorph(scratch, text_of(FLEXMORPH_SHORT_CASE, folder, {}, true)).code, code);
  EXPECT_EQ(io::read_csv(folder + "/history.csv").n_rows(), 6u);
  expect_same(lasting(folder), lasting(whole));
}

TEST(Resume, LeavesWhatIsDone) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const Words words = text_of(FLEXMORPH_SHORT_CASE, folder, {}, true);
  const int code = flexmorph(scratch, words).code;
  const std::string before = contents_of(folder + "/run.json");
  const Ended ended = flexmorph(scratch, words);
  EXPECT_EQ(ended.code, code) << ended.err;
  EXPECT_TRUE(testing::mentions_all(ended.out, {"complete"}, folder + ": "));
  EXPECT_EQ(contents_of(folder + "/run.json"), before);
}

}  // namespace
}  // namespace flexmorph::test
