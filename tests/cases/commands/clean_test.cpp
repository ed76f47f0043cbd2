// Shows that the command `clean` lists run folders with their states and removes those that were
// selected, if the user confirms it, and no others.
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>

#include "cases/output/old_runs.h"
#include "io/output_folder.h"
#include "tests/cases/program.h"
#include "tests/support/errors.h"

namespace flexmorph::test {
namespace {

namespace fs = std::filesystem;
using cases::OldRun;
using cases::OldRunSelection;

/// Writes a run folder with this status, whose results are so many hours old.
void write_run(const std::string& folder, const std::string& name, const std::string& status,
               double hours) {
  {
    io::OutputFolder output(folder);
    std::ofstream(output.file("run.json"))
        << "{\"case\": \"" << name << "\", \"status\": \"" << status << "\"}";
    std::ofstream(output.file("motion.csv")) << std::string(1000, '0');
  }
  fs::last_write_time(
      folder + "/run.json",
      fs::file_time_type::clock::now() - std::chrono::duration_cast<fs::file_time_type::duration>(
                                             std::chrono::duration<double>(3600 * hours)));
}

/// Writes five runs of two cases.
void write_runs(const Scratch& scratch) {
  write_run(scratch / "runs/a", "a", "done", 1);
  write_run(scratch / "runs/a.previous", "a", "interrupted", 50);
  write_run(scratch / "runs/a.previous.2", "a", "failed", 100);
  write_run(scratch / "runs/study/b1", "b", "done, not usable", 30);
  write_run(scratch / "runs/study/b2", "b", "running", 20);  // was killed
}

TEST(OldRuns, HaveNameStateAgeAndSize) {
  const Scratch scratch;
  write_runs(scratch);
  fs::create_directories(scratch / "runs/mine");
  scratch.write("runs/mine/run.json", "{\"case\": \"a\", \"status\": \"done\"}");
  fs::create_directory_symlink(scratch / "runs/a", scratch / "runs/link");
  const std::vector<OldRun> runs = cases::find_old_runs(scratch / "runs/");
  ASSERT_EQ(runs.size(), 5u);
  const char* states[] = {"finished", "interrupted", "failed", "finished", "interrupted"};
  for (size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(runs[i].state, states[i]);
    EXPECT_EQ(runs[i].case_name, i < 3 ? "a" : "b");
    EXPECT_NEAR(runs[i].bytes, 1030, 30);
  }
  EXPECT_NEAR(runs[1].age, 50 * 3600, 60);
  EXPECT_THROW(cases::find_old_runs(scratch / "missing"), Error);
  EXPECT_THROW(cases::find_old_runs(scratch / "runs/link/"), Error);
}

TEST(OldRuns, AreSelectedByAllConditions) {
  const std::vector<OldRun> runs = {{"1", "a", "finished", 10, 0},
                                    {"2", "a", "failed", 20, 0},
                                    {"3", "a", "running", 5, 0},
                                    {"4", "b", "finished", 40, 0},
                                    {"5", "b", "finished", 30, 0}};
  const auto selected = [&](const OldRunSelection& selection) {
    std::string out;
    const std::vector<bool> found = cases::selected_runs(runs, selection);
    for (size_t i = 0; i < runs.size(); ++i) out += found[i] ? runs[i].path : "";
    return out;
  };
  EXPECT_EQ(selected({}), "");
  EXPECT_EQ(selected({.all = true}), "1245");  // a running run is never selected
  EXPECT_EQ(selected({.older = 15}), "245");
  EXPECT_EQ(selected({.keep = 1}), "124");
  EXPECT_EQ(selected({.keep = 2}), "2");
  EXPECT_EQ(selected({.keep = 0}), "1245");
  EXPECT_EQ(selected({.older = 35, .keep = 1}), "4");
  EXPECT_EQ(selected({.older = 15, .all = true}), "245");
}

TEST(Clean, RemovesOnlyWhenAskedTwice) {
  const Scratch scratch;
  write_runs(scratch);
  scratch.write("runs/a.previous/notes.txt", "mine");
  const std::string folder = scratch / "runs";
  for (const Words& words :
       {Words{"clean", folder}, Words{"clean", folder, "--yes"}, Words{"clean", folder, "--all"}}) {
    const Ended ended = flexmorph(scratch, words);
    EXPECT_EQ(ended.code, 0) << ended.err;
    EXPECT_TRUE(testing::mentions_all(ended.out, {"finished", "failed", "interrupted", "5"}));
    EXPECT_EQ(cases::find_old_runs(folder).size(), 5u);
  }
  const Ended ended = flexmorph(scratch, {"clean", folder, "--older", "40h", "--yes"});
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_TRUE(testing::mentions_all(ended.out, {"removed: 2", "kB", "notes.txt"}));
  EXPECT_TRUE(fs::exists(folder + "/a/run.json"));
  EXPECT_FALSE(fs::exists(folder + "/a.previous.2"));
  EXPECT_EQ(contents_of(folder + "/a.previous/notes.txt"), "mine");
  EXPECT_FALSE(fs::exists(folder + "/a.previous/run.json"));
  EXPECT_EQ(cases::find_old_runs(folder).size(), 3u);
  EXPECT_EQ(flexmorph(scratch, {"clean", folder, "--older", "soon"}).code, 2);
  EXPECT_EQ(flexmorph(scratch, {"clean", scratch / "missing"}).code, 2);
}

TEST(Clean, NeverRemovesARunThatIsRunning) {
  const Scratch scratch;
  const std::string folder = scratch / "runs/out";
  testing::ChildProgram child = start(scratch, short_run(folder, {"time.step=1e-6"}));
  ASSERT_TRUE(eventually(child, [&] { return fs::exists(folder + "/run.json"); }));
  fs::create_directories(scratch / "other");
  const Ended ended = testing::run_shell(
      std::string("'") + FLEXMORPH_PROGRAM + "' clean '" + (scratch / "runs") + "' --all --yes",
      scratch / "other");
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_TRUE(testing::mentions_all(ended.out, {"running", "removed: 0"}));
  EXPECT_TRUE(fs::exists(folder + "/run.json"));
  child.send(SIGKILL);
  child.end();
}

}  // namespace
}  // namespace flexmorph::test
