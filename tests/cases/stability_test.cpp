// Shows that `flexmorph stability` assesses artificial run folders correctly, that its suites fit
// the shipped cases, that its processes keep their limits, and that the command works on a small
// scene.

#include "cases/stability/stability.h"

#include <gtest/gtest.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <set>

#include "cases/check/ready.h"
#include "cases/stability/suites.h"
#include "io/files.h"
#include "io/tables.h"
#include "tests/cases/program.h"
#include "tests/support/errors.h"

namespace flexmorph::cases {
namespace {

using test::Ended;
using test::Words;

/// A run folder of a motion whose numbers are all acceptable.
class Verdicts : public ::testing::Test {
 protected:
  Verdicts() {
    result_.directory = scratch_ / "run";
    std::filesystem::create_directories(result_.directory + "/loads");
    result_.status = "done";
    result_.ending.code = 0;
    write("motion.csv", "time,energy.kinetic\n0,2\n0.001,1\n");
    run({});
  }

  void write(const std::string& name, const std::string& text) {
    io::write_file(result_.directory + "/" + name, text);
  }
  /// Writes run.json with the given entries in its motion and the given warnings.
  void run(const std::string& motion, const std::string& warnings = "") {
    write("run.json", "{\"status\": \"done\", \"warnings\": [" + warnings +
                          "], \"motion\": {\"steps\": 2, \"newton_iterations\": 5" + motion + "}}");
  }
  void expect(StabilityVerdict verdict, const std::string& part) {
    const Assessment out = assess(result_);
    EXPECT_EQ(to_string(out.verdict), to_string(verdict)) << out.reason;
    EXPECT_TRUE(contains(out.reason, part)) << out.reason;
  }
  void failed(int code, const std::string& message) {
    result_.status = "failed";
    result_.message = message;
    result_.ending = {code, 0, false, 1};
  }

  Scratch scratch_;
  VariantResult result_;
};

TEST_F(Verdicts, StableWithTheNumbersOfTheRun) {
  run(R"(, "energy_error": 5e-7, "constraint_drift": 1e-12, "velocity_drift": 1e-6)"
      R"(, "rejected_steps": 3, "condition": 1e9, "smallest_area_ratio": 0.9)");
  const Assessment out = assess(result_);
  EXPECT_EQ(out.verdict, StabilityVerdict::stable) << out.reason;
  const std::array<double, 7> wanted = {5e-7, 1e-12, 1e-6, 2.5, 3, 1e9, 0.9};
  for (size_t i = 0; i < wanted.size(); ++i) EXPECT_EQ(out.numbers[i], wanted[i]) << kRunNumbers[i];
}

TEST_F(Verdicts, ANumberThatIsNotFiniteIsWrong) {
  for (const char* bad : {"nan", "-nan", "inf", "-inf", "NaN"}) {
    write("loads/plate.csv", std::string("time,force\n0,1\n1,") + bad + "\n");
    expect(StabilityVerdict::wrong, "loads/plate.csv:3");
  }
  write("loads/plate.csv", "nanometre,info\n1e-9,2\n");
  expect(StabilityVerdict::stable, "");
  run(R"(, "energy_error": null)");  // JSON has no NaN; the program writes null.
  expect(StabilityVerdict::wrong, "motion.energy_error");
}

TEST_F(Verdicts, CrashesAndHangsAreWrong) {
  failed(-1, "ended by signal 11");
  result_.ending = {-1, SIGSEGV, false, 1};
  expect(StabilityVerdict::wrong, "signal 11");
  result_.ending = {-1, SIGKILL, true, 60};
  expect(StabilityVerdict::wrong, "did not end");
  failed(1, "unexpected: std::bad_alloc");
  expect(StabilityVerdict::wrong, "std::bad_alloc");
}

TEST_F(Verdicts, TimeLimitsAndWarningsDegrade) {
  run("", R"("the balance of energy is missed by 20 %")");
  expect(StabilityVerdict::degraded, "missed by 20 %");
  failed(4, "ended after 60 CPU seconds");
  result_.ending.over_time = true;
  expect(StabilityVerdict::degraded, "60 CPU seconds");
}

TEST_F(Verdicts, RefusalsNeedAMessage) {
  for (const int code : {2, 3}) {
    failed(code, "a.toml:14:13: body.thickness = -1: a thickness is positive [m]");
    expect(StabilityVerdict::refused, "a.toml:14:13: body.thickness");
    failed(code, "");
    expect(StabilityVerdict::wrong, "");
  }
}

Scene shipped(const std::string& name, const Words& changes = {}) {
  return read_scene(io::CaseFile(find_case(name), changes));
}

TEST(Suites, EveryOneHasAShippedCaseItAppliesTo) {
  std::set<std::string> applied;
  for (const std::string& name : shipped_cases())
    for (const Suite& each : suites()) {
      const std::vector<Perturbation> list = each.rows(shipped(name));
      if (!list.empty()) applied.insert(each.name);
      std::set<std::string> parameters;
      for (const Perturbation& row : list) parameters.insert(row.parameter);
      EXPECT_EQ(parameters.size(), list.size()) << name << ", " << each.name;
    }
  EXPECT_EQ(applied.size(), suites().size());
  EXPECT_THROW(suite("nobody"), Error);
}

// Every key that a suite changes exists in the case.
TEST(Suites, ChangeKeysThatCasesHave) {
  // The reasons that the program gives for a key that does not exist, and for an entry without its
  // name.
  const auto reason = [](const std::string& name, const std::string& change) {
    const std::string text =
        testing::error_of(Error::Kind::input, [&] { shipped(name, {change}); });
    return text.substr(("--set " + change + ": ").size());
  };
  std::string unknown = reason("four_bar", "body.nobody=1");
  unknown = unknown.substr(0, unknown.find_first_of(",;"));
  ASSERT_FALSE(unknown.empty());
  const std::string unnamed = ".ENTRY.KEY";
  ASSERT_TRUE(contains(reason("motion_platform", "drive.nobody=1"), unnamed));
  for (const std::string& name : shipped_cases()) {
    const Scene scene = shipped(name);
    for (const Suite& each : suites())
      for (const Perturbation& row : each.rows(scene)) {
        Words changes = short_overrides(scene, row.part);
        changes.insert(changes.end(), row.overrides.begin(), row.overrides.end());
        try {
          shipped(name, changes);
        } catch (const Error& error) {
          EXPECT_FALSE(contains(error.what(), unknown)) << error.what();
          EXPECT_FALSE(contains(error.what(), unnamed)) << error.what();
        }
      }
  }
}

TEST(Children, EndWithinTheirLimits) {
  const Scratch scratch;
  std::vector<Child> children;
  for (const char* what :
       {"while :; do :; done", "trap '' INT; while :; do :; done", "kill -ABRT $$", "exit 0",
        "exec dd if=/dev/zero of=/dev/null bs=3G count=1"})
    children.push_back({{"-c", what}, scratch / std::to_string(children.size()), "/bin/sh"});
  ChildLimits limits;
  // CPU time [s]; the limit of wall time is ten times as long, because a busy machine starts a
  // shell slowly.
  limits.seconds = 1;
  limits.grace = 0.5;
  limits.memory = 2e9;
  std::vector<Ending> endings(children.size());
  size_t started = 0;
  EXPECT_TRUE(run_children(children, 2, limits,
                           {.started = [&](size_t i) { EXPECT_EQ(i, started++); },
                            .ended = [&](size_t i, const Ending& e) { endings[i] = e; }}));
  EXPECT_EQ(endings[0].signal, SIGINT);
  EXPECT_TRUE(endings[0].over_time);
  EXPECT_GE(endings[0].seconds, 1.0);
  EXPECT_EQ(endings[1].signal, SIGKILL);
  EXPECT_EQ(endings[2].signal, SIGABRT);
  EXPECT_FALSE(endings[2].over_time);
  EXPECT_EQ(endings[3].code, 0);
  EXPECT_EQ(endings[4].code, 1);  // dd cannot allocate its memory.
}

Words command(const std::string& folder, const Words& more) {
  Words out = {"stability", "plate_pendulum",       "-o",    folder,
               "--set",     "body.elements=[2, 2]", "--set", "body.youngs_modulus=1e7"};
  out.insert(out.end(), more.begin(), more.end());
  return out;
}

TEST(Stability, RunsSuitesAndTakesUpWhatItHas) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const Words words = command(folder, {"--suites", "rho_inf,step", "--jobs", "2"});
  const Ended first = test::flexmorph(scratch, words);
  EXPECT_EQ(first.code, 0) << first.out << first.err;
  const io::CsvTable table = io::read_csv(folder + "/stability.csv");
  const Words suites = table.texts("suite"), verdicts = table.texts("verdict");
  EXPECT_EQ(suites, (Words{"base", "rho_inf", "rho_inf", "rho_inf", "step", "step", "step", "step",
                           "step", "step"}));
  // With rho_inf = 1 (no numerical damping) the pin forces may alternate; the run warns about it.
  EXPECT_EQ(Words(verdicts.begin(), verdicts.begin() + 4),
            (Words{"stable", "stable", "stable", "degraded"}));
  EXPECT_TRUE(contains(table.texts("reason")[3], "rho_inf = 1"));
  EXPECT_TRUE(contains(contents_of(folder + "/stability.svg"), "rho_inf = 0.5"));
  EXPECT_TRUE(contains(contents_of(folder + "/stability.md"), "| rho_inf | 2 | 0 | 1 | 0 |"));

  const Ended second = test::flexmorph(scratch, words);
  EXPECT_EQ(second.code, 0);
  EXPECT_FALSE(contains(second.out, ": started")) << second.out;
  EXPECT_EQ(io::read_csv(folder + "/stability.csv").texts("verdict"), verdicts);
}

TEST(Stability, AWrongRowIsExitCode3) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const Words words = command(folder, {"--suites", "rho_inf", "--quiet"});
  ASSERT_EQ(test::flexmorph(scratch, words).code, 0);
  // A value that is not a number is added to the files of a row that is not run again.
  const std::string path = folder + "/plate_pendulum/rho_inf_1/motion.csv";
  io::write_file(path, contents_of(path) + "nan\n");
  const Ended ended = test::flexmorph(scratch, words);
  EXPECT_EQ(ended.code, 3);
  EXPECT_TRUE(contains(ended.out, "WRONG: plate_pendulum, rho_inf"));
}

TEST(Stability, RefusesWhatIsNotThere) {
  const Scratch scratch;
  for (const Words& words :
       {Words{"--suites", "nobody"}, Words{"nobody"}, Words{"--timeout", "0"}}) {
    Words all = {"stability", "-o", scratch / "none"};
    all.insert(all.end(), words.begin(), words.end());
    const Ended ended = test::flexmorph(scratch, all);
    EXPECT_EQ(ended.code, 2) << ended.err;
    EXPECT_FALSE(std::filesystem::exists(scratch / "none"));
  }
}

// Maps and tables do not depend on the locale of the program that writes them.
TEST(Stability, WritesTheSameInEveryLocale) {
  const Scratch scratch;
  StabilityRow row;
  row.case_name = "a, b";
  row.suite = "step";
  row.parameter = "h = 0.001 s";
  row.exit_code = 0;
  row.seconds_cpu = 1234.5;
  row.assessment.numbers[0] = 1234.5;
  write_stability_csv({&row, 1}, scratch / "plain.csv");
  const std::string svg = stability_svg({&row, 1}), text = stability_text({&row, 1}, true);
  const CommaLocale comma;
  write_stability_csv({&row, 1}, scratch / "comma.csv");
  EXPECT_EQ(contents_of(scratch / "comma.csv"), contents_of(scratch / "plain.csv"));
  EXPECT_EQ(stability_svg({&row, 1}), svg);
  EXPECT_EQ(stability_text({&row, 1}, true), text);
}

}  // namespace
}  // namespace flexmorph::cases
