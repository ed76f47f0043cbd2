// Shows that run folders survive second runs, killed processes, closed terminals, full disks,
// removed folders and names that lead out of them: files of the user stay, and files of a run are
// complete.
#include <csignal>
#include <filesystem>

#include "cases/study/study.h"
#include "geometry/sanitizers.h"
#include "io/tables.h"
#include "tests/cases/program.h"
#include "tests/cases/run_json.h"

namespace flexmorph::test {
namespace {

namespace fs = std::filesystem;

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// Returns a pendulum that is simulated for 1 s with the given step.
std::string pendulum(const std::string& steps, const std::string& more = "") {
  return "gravity = [0.0, -9.81]\n[time]\nend = 1.0\nstep = " + steps +
         "\n[[rigid_body]]\nname = \"rod\"\nmass = 1.0\nsize = [1.0, 0.1]\n"
         "[[joint]]\ntype = \"revolute\"\nname = \"pin\"\nb = \"rod\"\npoint_a = [-0.5, 0.0]\n"
         "point_b = [-0.5, 0.0]\n[output]\nvtk = false\nplots = false\n" +
         more;
}
const char* const kQuick = "1e-2";
const char* const kLong = "1e-6";  // a long run, to be killed

/// Waits until the table of steps has begun.
bool moves(const ChildProgram& run, const std::string& folder) {
  return eventually(run, [&] { return lines_of(contents_of(folder + "/motion.csv")).size() > 3; });
}

TEST(RunFolders, BelongToTheRunThatLives) {
  const Scratch scratch;
  const std::string folder = scratch / "out", slow = scratch.write("slow.toml", pendulum(kLong)),
                    quick = scratch.write("quick.toml", pendulum(kQuick));
  testing::ChildProgram child = start(scratch, {"run", slow, "-o", folder, "--quiet"});
  ASSERT_TRUE(moves(child, folder));
  const Scratch other_text;
  const std::string before = contents_of(folder + "/run.json");
  const fs::path words = fs::path(scratch / "second");
  fs::create_directories(words);
  // The second run is another process with output files of its own.
  const Ended refused =
      ChildProgram({FLEXMORPH_PROGRAM, "run", quick, "-o", folder, "--quiet"}, words.string())
          .end();
  EXPECT_EQ(refused.code, 2);
  EXPECT_TRUE(contains(refused.err, "process " + std::to_string(child.pid())));
  EXPECT_EQ(contents_of(folder + "/run.json"), before);
  child.send(SIGKILL);
  child.end();

  // A killed run does not block its folder: all its files are complete, and the next run moves them
  // away.
  EXPECT_EQ(run_json(folder)["status"], "running");
  const size_t columns = io::read_csv(folder + "/motion.csv").columns.size();
  EXPECT_GT(columns, 5u);
  const Ended ended = flexmorph(scratch, {"run", quick, "-o", folder});
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_TRUE(contains(ended.out, folder + ".previous"));
  EXPECT_EQ(run_json(folder)["status"], "done");
  EXPECT_EQ(run_json(folder + ".previous")["status"], "running");
}

// The table of a path grows during the run, as the table of a motion does, and a reader
// distinguishes running from killed runs.
TEST(RunFolders, OfTheDeadAreNotThoseOfTheLiving) {
  const Scratch scratch;
  const auto status = [&] {
    cases::StudyOptions options;
    options.directory = scratch / "";
    return cases::read_result(options, {"out", {}}).status;
  };
  EXPECT_EQ(status(), "missing");
  testing::ChildProgram child = start(scratch, {"run", "cantilever_roll_up", "-o", scratch / "out",
                                                "--set", "static.steps=100000", "--quiet"});
  const std::string path = scratch / "out/path.csv";
  ASSERT_TRUE(eventually(child, [&] { return lines_of(contents_of(path)).size() >= 5; }));
  EXPECT_EQ(status(), "running");
  child.send(SIGKILL);
  child.end();
  EXPECT_EQ(status(), "killed");
  const io::CsvTable table = io::read_csv(path);
  ASSERT_GT(table.n_rows(), 3u);
  // The first rows are those of the shipped case.
  EXPECT_EQ(table.columns.front(), "step");
  EXPECT_EQ(table.columns.back(), "iterations");
  EXPECT_EQ(table.numbers("step")[2], 2);
  EXPECT_NEAR(table.numbers("load_factor")[2], 2e-5, 1e-12);
}

TEST(RunFolders, AreNeverDestroyed) {
  const Scratch scratch;
  const std::string folder = scratch / "out", path = scratch.write("case.toml", pendulum(kQuick));
  for (int k = 0; k < 3; ++k) {
    ASSERT_EQ(flexmorph(scratch, {"run", path, "-o", folder, "--quiet"}).code, 0);
    scratch.write("out/design_notes.txt", "mine, " + std::to_string(k));
  }
  for (const char* ending : {"", ".previous", ".previous.2"}) {
    EXPECT_EQ(run_json(folder + ending)["status"], "done");
    EXPECT_TRUE(contents_of(folder + ending + "/design_notes.txt").starts_with("mine, "));
  }
}

TEST(RunFolders, RunAgainByThemselves) {
  const Scratch scratch;
  std::string table = "t,angle\n";
  for (int k = 0; k <= 20; ++k)
    table += std::to_string(0.05 * k) + "," + std::to_string(0.01 * k * k) + "\n";
  fs::create_directories(scratch / "here/tables");
  scratch.write("here/tables/turn.csv", table);
  scratch.write("here/case.toml",
                pendulum(kQuick,
                         "[[drive]]\nname = \"turn\"\ncsv = \"tables/turn.csv\"\ntime = "
                         "\"t\"\ncolumn = \"angle\"\n[[joint]]\ntype = "
                         "\"angle_drive\"\nname = \"motor\"\nb = \"rod\"\nangle = "
                         "\"turn\"\n"));
  const Ended first =
      flexmorph(scratch, {"run", scratch / "here/case.toml", "-o", scratch / "first", "--quiet"});
  ASSERT_EQ(first.code, 0) << first.err;
  fs::remove_all(scratch / "here");
  fs::rename(scratch / "first", scratch / "moved");
  const Ended again =
      flexmorph(scratch, {"run", scratch / "moved/case.toml", "-o", scratch / "again", "--quiet"});
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(contents_of(scratch / "moved/inputs/turn.csv"), table);
  EXPECT_EQ(contents_of(scratch / "again/motion.csv"), contents_of(scratch / "moved/motion.csv"));
  EXPECT_GT(contents_of(scratch / "again/motion.csv").size(), 1000u);
}

// Such a domain name would be part of the paths loads/NAME.csv and plots/start_NAME.svg.
TEST(RunFolders, AreNotLeftByNames) {
  const Scratch scratch;
  scratch.write("precious.csv", "years of work");
  for (const std::string& name : {std::string("../../precious"), std::string(300, 'a')}) {
    const Ended ended = flexmorph(scratch, {"run", "short_beam", "-o", scratch / "out/run", "--set",
                                            "domain.name='" + name + "'"});
    EXPECT_EQ(ended.code, 2);
    EXPECT_TRUE(contains(ended.err, "flexmorph: --set domain.name='" + name + "': "));
    EXPECT_TRUE(contains(ended.err, " 64 ")) << ended.err;
    EXPECT_FALSE(fs::exists(scratch / "out"));
  }
  EXPECT_EQ(contents_of(scratch / "precious.csv"), "years of work");
}

// A closed terminal (SIGHUP) ends a run as SIGTERM does.
TEST(RunFolders, AreFinishedWhenTheTerminalCloses) {
  for (const int signal : {SIGHUP, SIGTERM}) {
    const Scratch scratch;
    const std::string folder = scratch / "out", slow = scratch.write("slow.toml", pendulum(kLong));
    testing::ChildProgram child = start(scratch, {"run", slow, "-o", folder, "--quiet"});
    ASSERT_TRUE(moves(child, folder));
    child.send(signal);
    EXPECT_EQ(child.end().code, 4);
    EXPECT_EQ(run_json(folder)["status"], "interrupted");
    EXPECT_TRUE(fs::exists(folder + "/report.html"));
  }
}

// A run whose output pipe is closed continues to its end.
TEST(RunFolders, AreFinishedWhenNobodyListens) {
  const Scratch scratch;
  const std::string folder = scratch / "out", path = scratch.write("case.toml", pendulum(kQuick));
  const std::string command =
      std::string(FLEXMORPH_PROGRAM) + " run " + path + " -o " + folder + " | true";
  // The shell waits for both processes.
  EXPECT_EQ(testing::run_shell(command).code, 0);
  EXPECT_EQ(run_json(folder)["status"], "done");
}

// The size of files is limited to 20 kB, as on a full disk: the table ends with a complete row.
TEST(RunFolders, OnAFullDiskHoldWholeRows) {
  if (kThreadSanitized) GTEST_SKIP() << "the sanitizer has files of its own";
  const Scratch scratch;
  const std::string folder = scratch / "out", path = scratch.write("case.toml", pendulum("1e-3"));
  const std::string err = scratch / "err";
  const std::string command = "trap '' XFSZ; ulimit -f 40; exec " + std::string(FLEXMORPH_PROGRAM) +
                              " run " + path + " -o " + folder + " --quiet 2> " + err;
  EXPECT_EQ(testing::run_shell(command).code, 3);
  EXPECT_TRUE(contains(contents_of(err), "motion.csv: ")) << contents_of(err);
  EXPECT_TRUE(contains(contents_of(err), "File too large")) << contents_of(err);
  const std::string text = contents_of(folder + "/motion.csv");
  EXPECT_GT(text.size(), 15000u);
  EXPECT_EQ(text.back(), '\n');
  // read_csv() refuses incomplete rows
  EXPECT_GT(io::read_csv(folder + "/motion.csv").n_rows(), 50u);
  EXPECT_EQ(run_json(folder)["status"], "failed");
}

TEST(RunFolders, ThatAreRemovedEndTheRun) {
  const Scratch scratch;
  const std::string folder = scratch / "out", slow = scratch.write("slow.toml", pendulum("2e-6"));
  testing::ChildProgram child = start(scratch, {"run", slow, "-o", folder, "--quiet"});
  ASSERT_TRUE(moves(child, folder));
  fs::remove_all(folder);
  child.send(SIGTERM);
  const Ended ended = child.end();
  EXPECT_EQ(ended.code, 3);
  EXPECT_TRUE(contains(ended.err, folder)) << ended.err;
  EXPECT_TRUE(contains(ended.err, "removed")) << ended.err;
  EXPECT_FALSE(fs::exists(folder));
}

}  // namespace
}  // namespace flexmorph::test
