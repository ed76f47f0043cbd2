// Stability: verdicts on folders that are made up, the table of suites, limits around processes,
// and the command on a small scene.

#include "cases/stability/stability.h"

#include <gtest/gtest.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <set>

#include "cases/check/ready.h"
#include "cases/stability/report.h"
#include "io/files.h"
#include "io/tables.h"
#include "tests/cases/program.h"

namespace flexmorph::cases {
namespace {

using test::Ended;
using test::Words;

constexpr const char* kHead = "time,energy.kinetic,energy.strain,energy.potential,energy.defect\n";

/// The folder of a motion of a kilogram at 2 m/s whose numbers are all in order.
class Judged : public ::testing::Test {
 protected:
  Judged() {
    std::filesystem::create_directories(folder_ + "/loads");
    evidence_.folder = folder_;
    evidence_.row = &row_;
    evidence_.ending.code = 0;
    evidence_.bounds.emplace();
    evidence_.bounds->step = 1e-3;
    evidence_.bounds->omega = 10;  // (h omega)^2 = 1e-4
    evidence_.bounds->fastest = "bending of 'plate'";
    evidence_.bounds->mass = 1;
    write("motion.csv", std::string(kHead) + "0,2,0,0,0\n0.001,1,1,0,1e-6\n");
    run({});
  }

  void write(const std::string& name, const std::string& text) {
    io::write_file(folder_ + "/" + name, text);
  }
  /// run.json with these entries of its motion.
  void run(const std::string& motion, const std::string& more = "\"warnings\": []") {
    write("run.json", "{\"status\": \"done\", " + more +
                          ", \"motion\": {\"steps\": 2, \"newton_iterations\": 5" + motion + "}}");
  }
  void says(Verdict verdict, const std::string& part) {
    const Judgement out = judge(evidence_);
    EXPECT_EQ(to_string(out.verdict), to_string(verdict)) << out.reason;
    EXPECT_TRUE(contains(out.reason, part));
  }

  Scratch scratch_;
  std::string folder_ = scratch_ / "run";
  Perturbation row_;
  Evidence evidence_;
};

TEST_F(Judged, StableWhereEverythingHolds) {
  run(R"(, "energy_defect": 5e-7, "constraint_drift": 1e-12, "velocity_drift": 1e-6)");
  const Judgement out = judge(evidence_);
  EXPECT_EQ(out.verdict, Verdict::stable) << out.reason;
  EXPECT_EQ(out.figures.newton, 2.5);
  EXPECT_EQ(out.figures.energy_growth, 5e-7);  // 1e-6 of 2 J
}

TEST_F(Judged, NoNumberInAFileIsWrong) {
  for (const char* bad : {"nan", "-nan", "inf", "-inf", "NaN"}) {
    write("loads/plate.csv", std::string("time,force\n0,1\n1,") + bad + "\n");
    says(Verdict::wrong, "loads/plate.csv:3");
  }
  write("loads/plate.csv", "nanometre,info\n1e-9,2\n");
  says(Verdict::stable, "");
  run(R"(, "energy_defect": null)");  // how JSON says NaN
  says(Verdict::wrong, "motion.energy_defect");
  run({}, R"("results": [{"min_feature": null, "volume": 0.4}])");  // not evaluated
  says(Verdict::stable, "");
}

TEST_F(Judged, WithoutItsFilesIsWrong) {
  std::filesystem::remove(folder_ + "/motion.csv");
  says(Verdict::wrong, "motion.csv is missing");
  std::filesystem::remove(folder_ + "/run.json");
  says(Verdict::wrong, "run.json");
  write("run.json", R"({"status": "running"})");
  says(Verdict::wrong, "run.json");
}

TEST_F(Judged, EndsThatAreNoEnd) {
  evidence_.ending = {-1, SIGSEGV, false, 1};
  says(Verdict::wrong, "signal 11");
  evidence_.ending = {-1, SIGKILL, true, 60};
  says(Verdict::wrong, "hangs");
  evidence_.ending = {4, 0, true, 60};  // it ended as it was asked to
  says(Verdict::degraded, "too slow for the time limit: at t = 0.001 s");
  evidence_.ending = {1, 0, false, 1};
  evidence_.words = "flexmorph: unexpected: std::bad_alloc\n";
  says(Verdict::wrong, "exit code 1: unexpected: std::bad_alloc");
}

TEST_F(Judged, RefusedNeedsACause) {
  evidence_.path = "a.toml";
  evidence_.ending = {2, 0, false, 0};
  evidence_.words =
      "flexmorph: a.toml:14:13: body.thickness = -1: a thickness is positive [m]\n"
      "a.toml:15:9: body.width = 0: a width is positive [m]\n";
  says(Verdict::refused, "a.toml:14:13: body.thickness");
  evidence_.words = "flexmorph: --set body.thickness=-1: a thickness is positive [m]\n";
  says(Verdict::refused, "--set body.thickness");
  evidence_.words = "flexmorph: this is bad\n";
  says(Verdict::wrong, "without a cause");
}

// Not what it says to people counts, but what it leaves as data.
TEST_F(Judged, WhoGivesUpLeavesItsFailure) {
  evidence_.path = "a.toml";
  evidence_.ending = {3, 0, false, 0};
  evidence_.words = "flexmorph: no convergence at t = 0.3 s: |R| 4e-2 after 12 iterations\n";
  const auto failed = [&](const std::string& failure) {
    write("run.json", "{\"status\": \"failed\", \"failure\": {" + failure + "}}");
  };
  const std::string cause = R"("kind": "numerical", "cause": "no convergence")";
  says(Verdict::wrong, "without a cause");  // run.json of a run that is done
  failed(R"("phase": "motion", "time": 0.3, "step": 3, )" + cause);
  says(Verdict::refused, "t = 0.3 s");
  for (const char* where :
       {R"("phase": "statics", "load_factor": 0, )", R"("phase": "design", "iteration": 3, )"}) {
    failed(std::string(where) + cause);
    EXPECT_TRUE(names_cause(evidence_)) << where;
  }
  for (const std::string& missing :
       {R"("phase": "motion", )" + cause, R"("time": 0.3, )" + cause,
        std::string(R"("phase": "motion", "time": 0.3, "kind": "numerical", "cause": "")"),
        std::string(R"("phase": "motion", "time": 0, "kind": "defect", "cause": "bad_alloc")")}) {
    failed(missing);
    says(Verdict::wrong, "without a cause");
  }
  failed(R"("phase": "motion", "time": 0.3, )" + cause);
  row_.demand = Demand::runs;
  says(Verdict::wrong, "has to run");
}

TEST_F(Judged, WhatIsNoSceneMustNotRun) {
  row_.demand = Demand::refused;
  says(Verdict::wrong, "is no scene");
}

TEST_F(Judged, EnergyThatGrowsWithoutADrive) {
  evidence_.bounds->undriven = true;
  write("motion.csv", std::string(kHead) + "0,2,0,0,0\n0.001,2,0.5,0,0.5\n");
  run(R"(, "energy_defect": 0.2)");
  says(Verdict::wrong, "energy grows by 20 %");
  // The same with a word from the program, or within 10 %: said, and explained.
  run(R"(, "energy_defect": 0.2)", R"("warnings": ["the balance of energy is missed by 20 %"])");
  says(Verdict::degraded, "energy grows by 20 %");
  write("motion.csv", std::string(kHead) + "0,2,0,0,0\n0.001,2,0.1,0,0.1\n");
  run(R"(, "energy_defect": 0.05)");
  says(Verdict::degraded, "bound 0.01 %");
}

// Half of what is round-off is no defect.
TEST_F(Judged, EnergyThatIsRoundOff) {
  evidence_.bounds->rounding = 1e-9;
  write("motion.csv", std::string(kHead) + "0,0,1e-12,0,0\n0.001,0,1e-12,0,5e-13\n");
  run(R"(, "energy_defect": 0.5)");
  const Judgement out = judge(evidence_);
  EXPECT_EQ(out.verdict, Verdict::stable) << out.reason;
  EXPECT_FALSE(out.figures.energy_defect);
  evidence_.bounds->rounding = 1e-13;
  says(Verdict::wrong, "energy defect 50 %");
}

TEST_F(Judged, StepsThatAreTooCoarse) {
  evidence_.bounds->omega = 2000;
  write("motion.csv", std::string(kHead) + "0,2,0,0,0\n0.001,1,0.2,0,-0.8\n");
  run(R"(, "energy_defect": 0.4)", R"("warnings": ["the balance of energy is missed by 40 %"])");
  says(Verdict::degraded, "the step is too coarse, h omega = 2 for bending of 'plate'");
}

TEST_F(Judged, ConstraintsThatAreMissed) {
  run(R"(, "constraint_drift": 2e-8)");  // of a scene of 1 m
  says(Verdict::wrong, "constraints are missed by 2e-08 m");
  run(R"(, "velocity_drift": 1e-3)");  // 1e-4 of 2 m/s are allowed
  says(Verdict::degraded, "velocities miss the constraints");
  run(R"(, "velocity_drift": 1e-4)");
  says(Verdict::stable, "");
}

TEST_F(Judged, ExactLawsAndSaneRanges) {
  const std::string other = scratch_ / "base";
  std::filesystem::copy(folder_, other, std::filesystem::copy_options::recursive);
  evidence_.reference = other;
  row_.invariances = {{"energy.kinetic", {}, 2, 1e-9, 0, true, "it is twice that"}};
  says(Verdict::wrong, "energy.kinetic = 1, not 2: it is twice that");
  row_.invariances[0].factor = 1;
  says(Verdict::stable, "");
  row_.invariances = {{"energy.strain", 1.2, 1, 0.1, 0, false, "about 1.2"}};
  says(Verdict::degraded, "about 1.2");
  run({}, R"("warnings": ["it hangs on void"])");
  says(Verdict::degraded, "about 1.2; the run warns: it hangs on void");
  row_.invariances = {{"nothing.there", 1.2, 1, 0.1, 0, true, "is there"}};
  says(Verdict::wrong, "nothing.there = nothing");
}

TEST_F(Judged, VolumesBeyondWhatIsAllowed) {
  evidence_.largest_volume = 0.3;
  run({}, R"("results": [{"volume": 0.4}])");
  says(Verdict::wrong, "no warning says so");
  run({}, R"("results": [{"volume": 0.4}], "warnings": ["the volume is above max_volume"])");
  says(Verdict::degraded, "volume");
}

TEST_F(Judged, QuantitiesAreLastLargestAndSpan) {
  write("motion.csv", "time,plate.x\n0,-3\n1,1\n2,2\n");
  EXPECT_EQ(quantity_in(folder_, "plate.x"), 2);
  EXPECT_EQ(quantity_in(folder_, "plate.x.largest"), 3);
  EXPECT_EQ(quantity_in(folder_, "plate.x.span"), 5);
  EXPECT_FALSE(quantity_in(folder_, "plate.y"));
  run(R"(, "events": [{"time": 0.5}])");
  EXPECT_EQ(quantity_in(folder_, "events"), 1);
  run({}, R"("results": [{"compliance": 7.5, "connected": false}])");
  EXPECT_EQ(quantity_in(folder_, "compliance"), 7.5);
  EXPECT_EQ(quantity_in(folder_, "connected"), 0);
}

Scene shipped(const std::string& name, const Words& changes = {}) {
  return read_scene(io::CaseFile(find_case(name), changes));
}

/// The scene that suites about designs are for.
std::optional<Scene> short_design(const std::string& name, const Scene& whole) {
  if (whole.designs.empty()) return {};
  return shipped(name, short_overrides(whole, Part::design));
}

// A cantilever of 0.6 m (its longest), 0.1 m deep in the plane: 3.516/L² √(E/ρ) h/√12 = 54.3 rad/s;
// one turn per second is less. At h = 1e-3 energies hold to 0.0543² = 0.295 %.
TEST(BoundsOfAScene, FollowFromItsStep) {
  const Bounds bounds = bounds_of(shipped("rotating_plate_v01"));
  EXPECT_NEAR(bounds.omega, 54.26, 0.02);
  EXPECT_NEAR(bounds.defect(), 2.944e-3, 1e-5);
  EXPECT_FALSE(bounds.undriven);
  // 2700 · 0.6 · 0.1 · 0.01 + 0.5 kg; 2 J are 1.4 m/s.
  EXPECT_NEAR(bounds.mass, 2.12, 1e-12);
  EXPECT_NEAR(bounds.velocity(2), bounds.defect() * std::sqrt(4 / 2.12), 1e-15);
  EXPECT_TRUE(bounds_of(shipped("plate_pendulum")).undriven);
}

TEST(Suites, EveryOneHasAShippedCaseItAppliesTo) {
  std::set<std::string> applied;
  size_t rows = 0;
  for (const std::string& name : shipped_cases()) {
    const Scene whole = shipped(name);
    const std::optional<Scene> designed = short_design(name, whole);
    for (const Suite& each : suites()) {
      if (each.part == Part::design && !designed) continue;
      const Scene& scene = each.part == Part::design ? *designed : whole;
      const std::vector<Perturbation> list = each.rows(scene);
      if (!list.empty()) applied.insert(each.name);
      rows += list.size();
      std::set<std::string> parameters;
      for (const Perturbation& row : list) parameters.insert(row.parameter);
      EXPECT_EQ(parameters.size(), list.size()) << name << ", " << each.name;
    }
  }
  for (const std::string& name : suite_names()) EXPECT_TRUE(applied.contains(name)) << name;
  EXPECT_GE(rows, 200u);
  EXPECT_THROW(suite("nobody"), Error);
}

// What rows change is there to be changed: no key is unknown, none goes nowhere.
TEST(Suites, ChangeKeysThatCasesHave) {
  for (const std::string& name : shipped_cases()) {
    const Scene whole = shipped(name);
    const std::optional<Scene> designed = short_design(name, whole);
    for (const Suite& each : suites()) {
      if (each.part == Part::design && !designed) continue;
      const Scene& scene = each.part == Part::design ? *designed : whole;
      if (each.name == "components" || each.name == "iterations") continue;  // keys of `void`
      for (const Perturbation& row : each.rows(scene)) {
        Words changes = short_overrides(whole, row.part);
        changes.insert(changes.end(), row.overrides.begin(), row.overrides.end());
        try {
          shipped(name, changes);
        } catch (const Error& error) {
          EXPECT_FALSE(contains(error.what(), "unknown key"));
          EXPECT_FALSE(contains(error.what(), "entries; write"));
          EXPECT_NE(row.demand, Demand::runs) << name << ": " << error.what();
        }
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
  limits.seconds = 0.3;
  limits.grace = 0.3;
  limits.memory = 2e9;
  std::vector<Ending> endings(children.size());
  size_t started = 0;
  EXPECT_TRUE(run_children(children, 2, limits,
                           {.started = [&](size_t i) { EXPECT_EQ(i, started++); },
                            .ended = [&](size_t i, const Ending& e) { endings[i] = e; }}));
  EXPECT_EQ(endings[0].signal, SIGINT);
  EXPECT_TRUE(endings[0].over_time);
  EXPECT_GE(endings[0].seconds, 0.3);
  EXPECT_EQ(endings[1].signal, SIGKILL);
  EXPECT_EQ(endings[2].signal, SIGABRT);
  EXPECT_FALSE(endings[2].over_time);
  EXPECT_EQ(endings[3].code, 0);
  EXPECT_EQ(endings[4].code, 1);  // dd: memory exhausted
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
  const Words words = command(folder, {"--suites", "rho_inf,rest,joints", "--jobs", "2"});
  const Ended first = test::flexmorph(scratch, words);
  EXPECT_EQ(first.code, 0) << first.out << first.err;
  const io::CsvTable table = io::read_csv(folder + "/stability.csv");
  EXPECT_EQ(table.texts("suite"),
            (Words{"base", "rho_inf", "rho_inf", "rho_inf", "rest", "joints", "joints"}));
  for (size_t i = 0; i < 5; ++i) EXPECT_EQ(table.texts("verdict")[i], "stable");
  EXPECT_EQ(table.texts("verdict")[5], "refused");
  EXPECT_EQ(table.texts("exit_code")[5], "2");
  EXPECT_TRUE(contains(contents_of(folder + "/stability.svg"), "rho_inf = 0.5"));
  EXPECT_TRUE(contains(contents_of(folder + "/stability.md"), "| rho_inf | 3 | 3 | 0 | 0 | 0 |"));

  const std::string before = contents_of(folder + "/stability.csv");
  const Ended second = test::flexmorph(scratch, words);
  EXPECT_EQ(second.code, 0);
  EXPECT_FALSE(second.out.starts_with("1/")) << second.out;
  EXPECT_EQ(contents_of(folder + "/stability.csv"), before);
}

TEST(Stability, AWrongRowIsExitCode3) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const Words words = command(folder, {"--suites", "rest", "--quiet"});
  ASSERT_EQ(test::flexmorph(scratch, words).code, 0);
  // A number that cannot be true, in the files of a row that is not run again.
  const std::string path = folder + "/plate_pendulum/rest_1/motion.csv";
  io::write_file(path, contents_of(path) + "nan\n");
  const Ended ended = test::flexmorph(scratch, words);
  EXPECT_EQ(ended.code, 3);
  EXPECT_TRUE(contains(ended.out, "WRONG: plate_pendulum, rest"));
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

// The maps and tables are the same whatever the locale of the program that writes them.
TEST(Stability, WritesTheSameInEveryLocale) {
  const Scratch scratch;
  StabilityRow row;
  row.case_name = "a, b";
  row.suite = "step";
  row.perturbation.parameter = "h = 0.001 s";
  row.ending = {0, 0, false, 1234.5};
  row.judgement.figures.energy_defect = 1234.5;
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
