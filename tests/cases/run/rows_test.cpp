// Shows that the command lines of a study give its rows, that they may be repeated, that existing
// rows are collected and missing ones named, and what the exit codes of rows mean.

#include "cases/study/rows.h"

#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cases/study/sweep.h"
#include "io/files.h"
#include "io/shell.h"
#include "io/tables.h"
#include "tests/cases/program.h"
#include "tests/cases/run_json.h"
#include "tests/support/errors.h"

namespace flexmorph::cases {
namespace {

using test::Ended;
using test::Words;
namespace fs = std::filesystem;

TEST(ShellWords, AreReadBackByAShell) {
  const Scratch scratch;
  const Words words = {
      "plain-1.5,a=b/c:d+e", "two words", "it's", "$HOME `x` \"q\" \\", "", "a;b|c&d*", "[1, 2]"};
  const testing::ChildEnd end =
      testing::run_shell("printf '%s\\n' " + io::shell_line(words), scratch / "");
  EXPECT_EQ(test::lines_of(end.out), words);
  EXPECT_EQ(io::shell_word(words[0]), words[0]);
}

/// A plate that falls for a few steps: a row of it takes a twentieth of a second.
Words fall(const std::string& command, const std::string& folder, const Words& more) {
  Words out = {command, "plate_pendulum", "-o", folder};
  for (const char* change : {"body.elements=[2, 2]", "time.end=0.01", "output.vtk=false",
                             "output.plots=false", "expect=", "accuracy="})
    out.insert(out.end(), {"--set", change});
  out.insert(out.end(), more.begin(), more.end());
  return out;
}

const Words kVary = {"--vary", "body.thickness=0.01,0.012", "--vary", "time.step=1e-3,5e-4"};

/// A million steps of a plate without gravity, which stays at rest: this row ends only when a test
/// ends it. With gravity the soft plate folds, and the motion may fail before the test ends it.
const Words kLong = {"--set", "gravity=[0, 0, 0]", "--vary", "time.end=1000"};

Words with(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

/// Returns the columns of a table without those of times and memory.
std::vector<Words> lasting(const std::string& path) {
  const io::CsvTable table = io::read_csv(path);
  std::vector<Words> out;
  for (const std::string& name : table.columns)
    if (name.find("seconds") == std::string::npos && name.find("CPU") == std::string::npos &&
        name != "peak_memory_bytes")
      out.push_back(table.texts(name));
  return out;
}

Words statuses(const std::string& folder) {
  return io::read_csv(folder + "/rows.csv").texts("status");
}

/// Executes the program in a folder.
testing::ChildEnd in_folder(const std::string& folder, const Words& arguments,
                            const Scratch& scratch) {
  return testing::run_shell(
      "cd " + io::shell_word(folder) + " && " + FLEXMORPH_PROGRAM + " " + io::shell_line(arguments),
      scratch / "");
}

TEST(Rows, CommandLinesGiveTheStudyAndMayBeRepeated) {
  const Scratch scratch;
  const std::string here = scratch / "here", alone = scratch / "alone";
  fs::create_directories(here);
  fs::create_directories(alone);
  const Words words = with(fall("sweep", "runs/fall", {"--program", FLEXMORPH_PROGRAM}), kVary);
  const testing::ChildEnd printed = in_folder(here, with(words, {"--commands"}), scratch);
  ASSERT_EQ(printed.code, 0) << printed.err;
  const Words lines = test::lines_of(printed.out);
  ASSERT_EQ(lines.size(), 4U) << printed.out;
  for (const std::string& line : lines) {
    EXPECT_TRUE(starts(line, FLEXMORPH_PROGRAM + std::string(" run plate_pendulum --set ")));
    EXPECT_TRUE(contains(line, " -o runs/fall/"));  // relative to the working directory
    EXPECT_TRUE(ends(line, " --resume"));
    EXPECT_TRUE(contains(line, "'body.elements=[2, 2]'"));
  }
  EXPECT_FALSE(fs::exists(here + "/runs/fall/rows.csv"));

  // Only three rows are run: the table has them, and the fourth is named.
  const std::string jobs =
                        scratch.write("jobs", lines[0] + "\n" + lines[1] + "\n" + lines[3] + "\n"),
                    run = "cd " + here + " && sh -e " + jobs;
  ASSERT_EQ(testing::run_shell(run, scratch / "").code, 0);
  const testing::ChildEnd some = in_folder(here, with(words, {"--collect"}), scratch);
  EXPECT_EQ(some.code, 4) << some.err;
  EXPECT_EQ(statuses(here + "/runs/fall"), (Words{"done", "done", "missing", "done"}));
  EXPECT_TRUE(contains(some.out, "missing: step=1e-3,thickness=0.012"));
  EXPECT_FALSE(fs::exists(here + "/runs/fall/step=1e-3,thickness=0.012"));

  // All rows: those that are complete are not computed again.
  const std::string path = here + "/runs/fall/step=1e-3,thickness=0.01/run.json",
                    before = contents_of(path);
  scratch.write("jobs", printed.out);
  ASSERT_EQ(testing::run_shell(run, scratch / "").code, 0);
  EXPECT_EQ(contents_of(path), before);
  const testing::ChildEnd all = in_folder(here, with(words, {"--collect"}), scratch);
  EXPECT_EQ(all.code, 0) << all.out << all.err;
  EXPECT_FALSE(contains(all.out, "missing:"));
  ASSERT_EQ(in_folder(alone, with(words, {"--jobs", "2"}), scratch).code, 0);
  for (const char* table : {"/runs/fall/sweep.csv", "/runs/fall/rows.csv"})
    EXPECT_EQ(lasting(here + table), lasting(alone + table)) << table;
}

TEST(Rows, OfOtherCasesAndOriginsAreNamed) {
  const Scratch scratch;
  const std::string folder = scratch / "fall";
  const Words words = with(fall("sweep", folder, {}), kVary);
  ASSERT_EQ(test::flexmorph(scratch, with(words, {"--quiet"})).code, 0);
  const io::CsvTable table = io::read_csv(folder + "/rows.csv");
  const auto first_run = test::run_json(folder + "/" + table.texts("row")[0]);
  for (const char* key : {"version", "processor", "blas_kernel", "vectors"})
    EXPECT_FALSE(first_run[key].get<std::string>().empty()) << key;
  EXPECT_EQ(table.texts("version")[0], first_run["version"].get<std::string>());
  EXPECT_EQ(table.texts("processor")[0], first_run["processor"].get<std::string>());
  EXPECT_TRUE(contains(table.texts("kernels")[0], first_run["blas_kernel"].get<std::string>()));
  EXPECT_TRUE(contains(table.texts("kernels")[0], first_run["vectors"].get<std::string>()));
  EXPECT_FALSE(contains(contents_of(folder + "/sweep.md"), "origins"));

  // The folder of the second row gets the run of another case, and the third one another processor.
  const std::string second = folder + "/" + table.texts("row")[1],
                    third = folder + "/" + table.texts("row")[2];
  io::write_file(second + "/case.toml", "# " + contents_of(second + "/case.toml"));
  auto run = test::run_json(third);
  run["processor"] = "Abacus 9000";
  io::write_file(third + "/run.json", run.dump());
  const Ended ended = test::flexmorph(scratch, with(words, {"--collect"}));
  EXPECT_EQ(ended.code, 4);
  EXPECT_EQ(statuses(folder), (Words{"done", "another case", "done", "done"}));
  EXPECT_TRUE(contains(ended.out, "Abacus 9000"));
  EXPECT_TRUE(contains(contents_of(folder + "/sweep.md"), "Abacus 9000"));
  // The study runs the row of the other case anew and keeps that run beside it.
  const Ended again = test::flexmorph(scratch, words);
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(statuses(folder), Words(4, "done"));
  EXPECT_TRUE(fs::exists(second + ".previous/run.json"));
}

// More values, and another order of the keys, leave the rows that exist as they are.
TEST(Rows, AreKeptWhenAStudyIsExtended) {
  const Scratch scratch;
  const std::string folder = scratch / "fall";
  ASSERT_EQ(test::flexmorph(scratch, with(fall("sweep", folder, {"--quiet"}), kVary)).code, 0);
  const Ended more = test::flexmorph(
      scratch, with(fall("sweep", folder, {}),
                    {"--vary", "time.step=5e-4,1e-3,2e-3", "--vary", "body.thickness=0.01,0.012"}));
  EXPECT_EQ(more.code, 0) << more.err;
  size_t started = 0, before = 0;
  for (const std::string& line : test::lines_of(more.out)) {
    started += line.ends_with(": started");
    before += line.ends_with(": finished before");
  }
  EXPECT_EQ(started, 2U) << more.out;
  EXPECT_EQ(before, 4U) << more.out;
  EXPECT_EQ(statuses(folder), Words(6, "done"));
}

// A failed row is an answer; a row at its limit of CPU time is one until the limit is larger.
TEST(Rows, ThatFailedAreNotRepeated) {
  const Scratch scratch;
  const std::string folder = scratch / "study", row = folder + "/end=1000";
  const Words words = with(fall("sweep", folder, {"--program", FLEXMORPH_PROGRAM}), kLong);
  const std::string line =
      test::lines_of(test::flexmorph(scratch, with(words, {"--commands"})).out).at(0);
  ASSERT_EQ(testing::run_shell(line + " --seconds 0.3", scratch / "").code, 3);
  const std::string text = contents_of(row + "/run.json");
  EXPECT_EQ(test::run_json(row)["status"], "failed");
  EXPECT_EQ(test::run_json(row)["failure"]["kind"], "limit");
  const Ended again = test::flexmorph(scratch, words);
  EXPECT_EQ(again.code, 3);
  EXPECT_FALSE(contains(again.out, "started")) << again.out;
  EXPECT_TRUE(contains(again.err, "end=1000"));
  EXPECT_EQ(contents_of(row + "/run.json"), text);

  StudyOptions study;
  study.case_name = "plate_pendulum";
  study.directory = folder;
  for (size_t i = 0; i < words.size(); ++i)
    if (words[i] == "--set") study.overrides.push_back(words[i + 1]);
  const Variant variant{"end=1000", {"time.end=1000"}};
  VariantResult result = read_result(study, variant);
  EXPECT_TRUE(result.ending.over_time);
  EXPECT_TRUE(is_answered(study, variant, result));
  study.time_limit = 1000;
  EXPECT_FALSE(is_answered(study, variant, result));
  result.ending.over_time = false;
  EXPECT_TRUE(is_answered(study, variant, result));
  // A full disk is no result.
  VariantResult full = result;
  full.message = "S/end=1000/motion.csv: cannot be written: No space left on device";
  EXPECT_FALSE(is_answered(study, variant, full));
  EXPECT_EQ(exit_code_of(study, {&result, 1}), 3);
  result.status = "interrupted";
  EXPECT_FALSE(is_answered(study, variant, result));
  EXPECT_EQ(exit_code_of(study, {&result, 1}), 4);
}

// A row that crashes is killed: the call has exit code 4, as that of --collect, and runs it again.
TEST(Rows, ThatCrashAreRepeated) {
  const Scratch scratch;
  const std::string row = scratch / "study/end=1000";
  const Words words = with(fall("sweep", scratch / "study", {}), kLong);
  Words study = {FLEXMORPH_PROGRAM};
  study.insert(study.end(), words.begin(), words.end());
  testing::ChildProgram sweep(study, scratch / "");
  ASSERT_TRUE(testing::eventually(sweep, [&] {
    return test::lines_of(contents_of(row + "/motion.csv")).size() > 20;
  })) << sweep.end().err;
  const std::string pid = std::to_string(sweep.pid());
  testing::run_shell("kill -KILL $(cat /proc/" + pid + "/task/" + pid + "/children)", scratch / "");
  const testing::ChildEnd end = sweep.end();
  EXPECT_EQ(end.code, 4) << end.out << end.err;
  EXPECT_EQ(statuses(scratch / "study"), Words{"killed"});
  EXPECT_EQ(test::flexmorph(scratch, with(words, {"--collect"})).code, 4);
}

// SIGTERM ends a row whole with exit code 4; the same line continues it bit for bit.
TEST(Rows, ContinueAfterSigterm) {
  const Scratch scratch;
  // The motion of a stiff plate is regular: it does not fail, and does not depend on the processor.
  const Words stiff = {"--set", "body.youngs_modulus=1e9"};
  const Words words =
      with(fall("sweep", scratch / "cut", {"--program", FLEXMORPH_PROGRAM, "--vary", "time.end=4"}),
           with(stiff, {"--commands"}));
  std::string line = test::lines_of(test::flexmorph(scratch, words).out).at(0);
  testing::ChildProgram row({"sh", "-c", "exec " + line}, scratch / "");
  ASSERT_TRUE(testing::eventually(row, [&] {
    return test::lines_of(contents_of(scratch / "cut/end=4/motion.csv")).size() > 20;
  })) << row.end().err;
  row.send(SIGTERM);
  const testing::ChildEnd first = row.end();
  ASSERT_EQ(first.code, 4) << first.err;
  EXPECT_EQ(test::run_json(scratch / "cut/end=4")["status"], "interrupted");
  Words collect = words;
  collect.back() = "--collect";
  EXPECT_EQ(test::flexmorph(scratch, collect).code, 4);
  EXPECT_EQ(statuses(scratch / "cut"), Words{"interrupted"});
  ASSERT_EQ(testing::run_shell(line, scratch / "").code, 0);
  EXPECT_EQ(test::flexmorph(scratch, collect).code, 0);
  const Words whole =
      with(fall("run", scratch / "whole", {"--set", "time.end=4", "--quiet"}), stiff);
  ASSERT_EQ(test::flexmorph(scratch, whole).code, 0);
  EXPECT_EQ(contents_of(scratch / "cut/end=4/motion.csv"),
            contents_of(scratch / "whole/motion.csv"));
}

TEST(Rows, AreThoseOfComparisonsAndStability) {
  const Scratch scratch;
  const Words start = {"-o", scratch / "study", "--program", FLEXMORPH_PROGRAM, "--commands"};
  const Ended compare = test::flexmorph(
      scratch,
      with({"compare", "short_beam", "--optimizers", "mma,ipopt", "--starts", "2"}, start));
  EXPECT_EQ(compare.code, 0) << compare.err;
  EXPECT_EQ(test::lines_of(compare.out).size(), 4U) << compare.out;
  fs::remove_all(scratch / "study");

  // The rows of a stability study have limits of memory and CPU time.
  const Words words = with({"stability", "plate_pendulum", "--suites", "rho_inf", "--set",
                            "body.elements=[2, 2]", "--timeout", "30"},
                           start);
  const Ended stability = test::flexmorph(scratch, words);
  ASSERT_EQ(stability.code, 0) << stability.err;
  ASSERT_EQ(testing::run_shell(stability.out, scratch / "").code, 0) << stability.out;
  Words collect = words;
  collect.back() = "--collect";
  EXPECT_EQ(test::flexmorph(scratch, collect).code, 0);
  EXPECT_EQ(io::read_csv(scratch / "study/stability.csv").texts("suite"),
            (Words{"base", "rho_inf", "rho_inf", "rho_inf"}));
}

TEST(Rows, AreThoseOfAccuracyAndVerifyRecommendations) {
  const Scratch scratch;
  const std::string folder = scratch / "study";
  Words words = {"accuracy",
                 "plate_pendulum",
                 "--refinements",
                 "step",
                 "-o",
                 folder,
                 "--program",
                 FLEXMORPH_PROGRAM,
                 "--set",
                 "body.elements=[2, 2]",
                 "--set",
                 "body.youngs_modulus=1e6",
                 "--set",
                 "accuracy.at=0.02",
                 "--set",
                 "accuracy.reference=",
                 "--commands"};
  const auto call = [&](const char* mode) {
    words.back() = mode;
    return test::flexmorph(scratch, words);
  };
  EXPECT_EQ(call("--collect").code, 4);
  const Ended levels = call("--commands");
  ASSERT_EQ(levels.code, 0) << levels.err;
  const size_t n_levels = test::lines_of(levels.out).size();
  EXPECT_GE(n_levels, 4U) << levels.out;
  testing::run_shell(levels.out, scratch / "");
  const Ended more = call("--commands");
  ASSERT_EQ(more.code, 0) << more.err;
  EXPECT_GT(test::lines_of(more.out).size(), n_levels) << more.out;  // recommended settings
  testing::run_shell(more.out, scratch / "");
  const Ended collected = call("--collect");
  EXPECT_LE(collected.code, 4);
  EXPECT_GE(io::read_csv(folder + "/accuracy.csv").n_rows(), n_levels - 1);
  EXPECT_TRUE(fs::exists(folder + "/rows.csv"));
}

}  // namespace
}  // namespace flexmorph::cases
