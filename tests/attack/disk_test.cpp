// Shows that a run ends with one sentence and exit code 2 or 3, and leaves complete files, if its
// disk becomes full or its folder is removed, cannot be written, or belongs to another user.
//
//   FLEXMORPH_DISKS=20 build/tests/attack/attack_tests --gtest_filter='Disk.*'   sizes, default 1
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <map>
#include <optional>
#include <thread>

#include "tests/attack/children.h"
#include "tests/attack/mutations.h"
#include "tests/attack/run_files.h"
#include "tests/io/scratch.h"
#include "tests/support/child_program.h"
#include "tests/support/errors.h"

namespace flexmorph {
namespace {

namespace fs = std::filesystem;
using testing::ChildEnd;
using testing::ChildProgram;
using Words = std::vector<std::string>;

constexpr double kMega = 1e6;

/// A pendulum that is simulated for about a second.
const char* const kPendulum =
    "gravity = [0.0, -9.81]\n[time]\nend = 1.0\nstep = 2e-4\n"
    "[[rigid_body]]\nname = \"rod\"\nmass = 1.0\nsize = [1.0, 0.1]\n"
    "[[joint]]\ntype = \"revolute\"\nname = \"pin\"\nb = \"rod\"\npoint_a = [-0.5, 0.0]\n"
    "point_b = [-0.5, 0.0]\n[output]\nmotion_every = 0.005\n";

struct Kind {
  const char* name;
  Words words;          ///< Words of the command, without the folder.
  const char* growing;  ///< A file in the folder that shows that the run has begun.
};

/// Returns a motion, a design in a motion, a static path, a static design, and a study.
std::vector<Kind> kinds(const std::string& pendulum) {
  return {{"motion", {"run", pendulum}, "motion.csv"},
          {"design",
           {"run", FLEXMORPH_SHORT_CASE, "--set", "design.cell=0.01", "--set",
            "design.min_thickness=0.01", "--set", "esl.every=0.02"},
           "history.csv"},
          {"path", {"run", "cantilever_roll_up", "--set", "static.steps=60"}, "path.csv"},
          {"design at rest",
           {"run", "short_beam", "--set", "optimizer.max_iterations=12", "--set",
            "expect=", "--set", "design.cell=0.05", "--set", "design.min_feature=0"},
           "history.csv"},
          {"study",
           {"sweep", pendulum, "--vary", "time.step=2e-4,2.5e-4,3e-4"},
           "step=2e-4/motion.csv"}};
}

Words command(const Kind& kind, const std::string& folder) {
  Words out = {FLEXMORPH_PROGRAM};
  out.insert(out.end(), kind.words.begin(), kind.words.end());
  out.insert(out.end(), {"-o", folder, "--quiet"});
  return out;
}

/// Waits until a file is longer than a number of bytes, or the process has ended.
void wait_for(const std::string& path, size_t bytes, const ChildProgram& process) {
  std::error_code none;
  for (int k = 0; k < 60'000 && process.runs(); ++k) {
    if (fs::exists(path, none) && fs::file_size(path, none) > bytes) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

/// Expects exit code 2 or 3 with a message, no crash and no time-out. @returns the code
int refused(const ChildEnd& end, const std::string& what) {
  EXPECT_FALSE(end.timed_out) << what;
  EXPECT_TRUE(end.code == 2 || end.code == 3)
      << what << ": exit code " << end.code << ", signal " << end.signal << "\n"
      << end.err;
  EXPECT_TRUE(contains(end.err, "flexmorph: ")) << what;
  EXPECT_FALSE(contains(end.err, "unexpected")) << what;
  return end.code;
}

/// Expects a refusal, or a complete run. @returns the exit code
int refused_or_whole(const ChildEnd& end, const std::string& what) {
  if (end.code == 0 || end.code == 5) return end.code;
  return refused(end, what);
}

TEST(Disk, FillsUpAtAnyMoment) {
  const Scratch scratch;
  const std::string pendulum = scratch.write("pendulum.toml", kPendulum);
  testing::Mutations random(testing::number_of("FLEXMORPH_SEED", 1));
  for (const Kind& kind : kinds(pendulum)) {
    const std::string whole = scratch / "whole";
    const ChildEnd undisturbed = ChildProgram(command(kind, whole), scratch / "").end();
    ASSERT_TRUE(undisturbed.code == 0 || undisturbed.code == 5) << undisturbed.err;
    ASSERT_EQ(testing::broken_files(whole), "");
    const double size = testing::size_of(whole);
    std::map<int, int> codes;
    bool on_disk = true;
    const size_t n = testing::number_of("FLEXMORPH_DISKS", 1);
    for (size_t k = 0; k < n; ++k) {
      const double bytes = size * static_cast<double>(random.below(1000)) / 1000;
      const std::string what = std::string(kind.name) + " with " + std::to_string(bytes) + " bytes";
      const testing::SmallDisk disk(scratch / "disk", size + 300 * kMega);
      const std::string folder = scratch / "disk/run";
      on_disk = disk.mounted();
      // Without a disk of its own the size of files is limited instead.
      ChildProgram process(command(kind, folder), scratch / "",
                           {.file_size = on_disk ? 0 : bytes / 4 + 1});
      if (on_disk) {
        wait_for(folder + "/.flexmorph", 0, process);
        EXPECT_TRUE(disk.fill_up_to(bytes));
      }
      ++codes[refused_or_whole(process.end(), what)];
      EXPECT_EQ(testing::broken_files(folder), "") << what;
      if (!on_disk) fs::remove_all(scratch / "disk");
    }
    std::string counts;
    for (const auto& [code, count] : codes)
      counts += ", exit code " + std::to_string(code) + ": " + std::to_string(count);
    std::printf("%s, %.1f MB, %zu sizes of %s%s\n", kind.name, size / kMega, n,
                on_disk ? "a disk" : "files", counts.c_str());
    fs::remove_all(whole);
  }
}

TEST(Disk, TakesNothing) {
  const Scratch scratch;
  const std::string pendulum = scratch.write("pendulum.toml", kPendulum);
  const std::string a_file = scratch.write("file", "mine");
  testing::SmallDisk disk(scratch / "disk", 300 * kMega);
  const bool read_only = disk.mounted() && disk.make_read_only();
  for (const Kind& kind : kinds(pendulum)) {
    EXPECT_EQ(refused(ChildProgram(command(kind, a_file + "/run"), scratch / "").end(), kind.name),
              2);
    if (read_only) {
      EXPECT_EQ(
          refused(ChildProgram(command(kind, scratch / "disk/run"), scratch / "").end(), kind.name),
          2);
    }
  }
  EXPECT_EQ(contents_of(a_file), "mine");
  std::printf("a path below a file%s\n", read_only ? ", and a disk that is read-only" : " only");
}

TEST(Disk, RemovedFoldersEndTheRun) {
  const Scratch scratch;
  std::string slow = kPendulum;
  slow.replace(slow.find("2e-4"), 4, "2e-6");
  for (Kind kind : kinds(scratch.write("pendulum.toml", slow))) {
    const std::string folder = scratch / "run";
    if (std::string(kind.name) == "path") kind.words.back() = "static.steps=2000";
    if (std::string(kind.name) == "design at rest") kind.words[3] = "optimizer.max_iterations=2000";
    if (std::string(kind.name) == "study") kind.words.back() = "time.step=2e-6,3e-6";
    const std::string growing =
        std::string(kind.name) == "study" ? std::string("step=2e-6/motion.csv") : kind.growing;
    ChildProgram process(command(kind, folder), scratch / "");
    wait_for(folder + "/" + growing, 500, process);
    ASSERT_TRUE(process.runs()) << kind.name;
    std::error_code none;
    for (int k = 0; k < 100 && fs::exists(folder, none); ++k) fs::remove_all(folder, none);
    kill(process.pid(), SIGTERM);  // motions and paths would continue in removed files
    EXPECT_EQ(refused(process.end(), kind.name), 3);
    EXPECT_FALSE(fs::exists(folder)) << kind.name;
  }
}

TEST(Disk, FoldersOfOthersStayAsTheyAre) {
  const Scratch scratch;
  const std::string pendulum = scratch.write("pendulum.toml", kPendulum);
  for (const Kind& kind : kinds(pendulum)) {
    if (std::string(kind.name) == "study") continue;
    for (const char* name : {"notes.txt", "run.json", "design_final.dxf", ".flexmorph/list"}) {
      const fs::path folder = scratch / "theirs";
      fs::create_directories((folder / name).parent_path());
      scratch.write("theirs/" + std::string(name), "mine");
      EXPECT_EQ(
          refused(ChildProgram(command(kind, folder.string()), scratch / "").end(), kind.name), 2);
      EXPECT_EQ(contents_of((folder / name).string()), "mine");
      fs::remove_all(folder);
    }
  }
}

TEST(Disk, FoldersOfTheLivingAreTheirs) {
  const Scratch scratch;
  std::string slow = kPendulum;
  slow.replace(slow.find("2e-4"), 4, "2e-6");
  const std::string pendulum = scratch.write("pendulum.toml", slow);
  fs::create_directories(scratch / "second");
  for (const Kind& kind : kinds(pendulum)) {
    const bool study = std::string(kind.name) == "study";
    Kind first = kind;
    if (study) first.words.back() = "time.step=2e-6,3e-6";
    if (!study) first = kinds(pendulum).front();
    const std::string folder = scratch / ("run of " + std::string(kind.name));
    std::optional<ChildProgram> process(std::in_place, command(first, folder), scratch / "");
    wait_for(folder + (study ? "/step=2e-6/motion.csv" : "/motion.csv"), 500, *process);
    kill(process->pid(), SIGSTOP);  // it must still exist, however fast the machine is
    const ChildEnd end = ChildProgram(command(kind, folder), scratch / "second").end();
    EXPECT_EQ(refused(end, kind.name), 2);
    EXPECT_TRUE(testing::mentions_all(end.err, {"'" + folder + "'", "process "}));
    EXPECT_TRUE(process->runs());
    process.reset();
    testing::wait_for_children(folder);  // before their files are removed
  }
}

}  // namespace
}  // namespace flexmorph
