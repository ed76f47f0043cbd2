// Shows that a short run writes the documented folder (cases/docs/output.md), that a
// second run writes equal bytes, and what remains after a failure and an interruption.

#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <map>
#include <thread>

#include "io/tables.h"
#include "tests/cases/program.h"
#include "tests/cases/run_json.h"
#include "tests/support/errors.h"

namespace flexmorph::test {
namespace {

namespace fs = std::filesystem;
using Table = std::vector<Words>;

Table read_csv(const std::string& path) {
  Table rows;
  for (const std::string& line : lines_of(contents_of(path))) {
    Words row;
    std::istringstream in(line);
    for (std::string cell; std::getline(in, cell, ',');) row.push_back(cell);
    if (line.ends_with(',')) row.emplace_back();
    rows.push_back(row);
  }
  return rows;
}

int count(const std::string& text, const std::string& part) {
  int n = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

constexpr const char* kHistoryHeader =
    "body,cycle,iteration,evaluations,scaled_objective,compliance,volume,violation,kkt,change,band,"
    "crisp_compliance,crisp_volume,connected,min_feature,seconds_tdf,seconds_outlines,"
    "seconds_factor,seconds_solve,seconds_sensitivity,seconds_optimizer,seconds_output";

void expect_history(const Table& history) {
  const Words& header = history[0];
  const auto column = [&](const char* name) {
    return static_cast<size_t>(std::find(header.begin(), header.end(), name) - header.begin());
  };
  ASSERT_GE(history.size(), 3u);
  for (size_t r = 1; r < history.size(); ++r) {
    const Words& row = history[r];
    ASSERT_EQ(row.size(), header.size());
    EXPECT_EQ(row[column("body")], "plate");
    EXPECT_EQ(row[column("iteration")], std::to_string(r));
    const double compliance = std::stod(row[column("compliance")]);
    EXPECT_NEAR(std::log(compliance), std::stod(row[column("scaled_objective")]), 1e-12);
    const bool crisp = r % 4 == 0;
    for (const char* name : {"crisp_compliance", "crisp_volume", "connected"})
      EXPECT_EQ(row[column(name)].empty(), !crisp) << name << " in row " << r;
  }
}

void expect_motion(const Table& motion) {
  EXPECT_EQ(motion[0], (Words{"time", "plate.tip_deflection", "plate.length", "hub.force_x",
                              "hub.force_y", "hub.moment", "hub.power", "energy.kinetic",
                              "energy.strain", "energy.potential", "energy.error"}));
  ASSERT_GE(motion.size(), 122u);  // 120 steps, the start and the header
  EXPECT_EQ(motion[1][0], "0");
  EXPECT_NEAR(std::stod(motion.back()[0]), 0.12, 1e-12);
  EXPECT_NEAR(std::stod(motion.back()[2]), 0.56, 1e-12);
}

void expect_run_json(const json& run) {
  for (const char* key : {"version", "libraries", "blas_kernel", "threads", "status",
                          "seconds_wall", "seconds_cpu", "peak_memory_bytes", "warnings"})
    EXPECT_TRUE(run.contains(key)) << key;
  EXPECT_EQ(run["status"], "done, not usable");
  EXPECT_EQ(run["threads"], 1);
  EXPECT_GT(run["peak_memory_bytes"].get<double>(), 1e6);
  double phases = 0;  // the sum of the phases is at most the total
  for (const char* name : {"solve", "output", "unloaded_components", "motion",
                           "outline_verification", "verification"}) {
    ASSERT_TRUE(run["seconds_by_phase"].contains(std::string("seconds_") + name)) << name;
    phases += run["seconds_by_phase"][std::string("seconds_") + name].get<double>();
  }
  EXPECT_LE(phases, run["seconds_cpu"].get<double>());
  ASSERT_EQ(run["results"].size(), 1u);
  const json& plate = run["results"][0];
  for (const char* key : {"compliance", "volume", "crisp_compliance", "crisp_volume",
                          "uniform_compliance", "connected", "min_feature", "dynamic_amplitude",
                          "uniform_dynamic_amplitude", "cycles", "iterations", "state_solves"})
    EXPECT_TRUE(plate.contains(key)) << key;
  EXPECT_EQ(plate["iterations"], 6);
  EXPECT_EQ(plate["cycles"], 1);
  EXPECT_EQ(plate["loads"], 12);
  for (const char* key : {"compliance", "uniform_compliance", "dynamic_amplitude"})
    EXPECT_GT(plate[key].get<double>(), 0) << key;
  ASSERT_EQ(run["motion"]["events"].size(), 1u);
  EXPECT_NEAR(run["motion"]["events"][0]["time"].get<double>(), 0.1, 1e-12);
}

TEST(Run, WritesItsFolder) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const Ended ended = flexmorph(scratch, short_run(folder));
  ASSERT_EQ(ended.code, kTooFew) << ended.err;
  // The design of six iterations is not usable; its warnings depend on the path of the optimizer.
  EXPECT_EQ(ended.err.rfind("flexmorph: not usable: ", 0), 0u) << ended.err;
  const auto told = run_json(folder).at("warnings");
  for (const auto& each : told)
    EXPECT_NE(ended.err.find(each.get<std::string>()), std::string::npos) << each;
  EXPECT_EQ(lines_of(ended.err).size(), told.size());

  for (const char* name : {"case.toml",
                           "run.json",
                           "history.csv",
                           "motion.csv",
                           "motion_uniform.csv",
                           "design/iterations.pvd",
                           "design/components.pvd",
                           "design/fields.pvd",
                           "motion/motion.pvd",
                           "loads/plate.csv",
                           "plots/convergence_plate.svg",
                           "plots/deflection.svg",
                           "plots/energies.svg",
                           "plots/design.png",
                           "report.html",
                           "components.csv",
                           "design.svg",
                           "design.dxf",
                           "design.stl",
                           "design.step",
                           "paraview.py"})
    EXPECT_TRUE(fs::is_regular_file(folder + "/" + name)) << name;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    EXPECT_NE(entry.path().extension(), ".tmp") << entry.path();

  EXPECT_EQ(lines_of(contents_of(folder + "/history.csv"))[0], kHistoryHeader);
  const Table history = read_csv(folder + "/history.csv");
  expect_history(history);
  EXPECT_EQ(history.size(), 7u);
  for (const auto& [series, frames] :
       {std::pair{"iterations", 6}, std::pair{"fields", 1}, std::pair{"components", 1}}) {
    const std::string index = contents_of(folder + "/design/" + std::string(series).append(".pvd"));
    EXPECT_EQ(count(index, "<DataSet "), frames) << index;
  }
  // Plate, hub and point mass at 0, .04, .08, .12 s.
  EXPECT_EQ(count(contents_of(folder + "/motion/motion.pvd"), "<DataSet "), 12);
  EXPECT_EQ(read_csv(folder + "/loads/plate.csv").size(), 13u);
  EXPECT_EQ(read_csv(folder + "/components.csv").size(), 25u);
  expect_motion(read_csv(folder + "/motion.csv"));
  expect_run_json(run_json(folder));

  // case.toml is a complete case that gives the same check.
  const Ended check = flexmorph(scratch, {"check", folder + "/case.toml"});
  EXPECT_EQ(check.code, 0) << check.err;
  for (const char* part : {"24 components", "168 variables", "112 x 20"})
    EXPECT_TRUE(contains(check.out, part));
}

// The measure of the best cycle equals the value computed here from the written motion.
TEST(Run, ComparesCyclesByTheDeflectionOfATip) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const Ended ended =
      flexmorph(scratch, {"run", FLEXMORPH_TWO_PLATES, "-o", folder, "--set",
                          "cycle.compare_by=peak_to_peak", "--set", "cycle.compare_point=heavy"});
  ASSERT_EQ(ended.code, kTooFew) << ended.err;
  const std::vector<double> tip =
      io::read_csv(folder + "/motion.csv").numbers("heavy.tip_deflection");
  const auto [least, largest] = std::minmax_element(tip.begin(), tip.end());
  bool found = false;
  const json run = run_json(folder);
  for (const json& cycle : run["cycles"]) {
    if (!cycle["best"].get<bool>()) continue;
    found = true;
    EXPECT_NEAR(cycle["measure"].get<double>(), *largest - *least, 1e-12 * (*largest - *least));
  }
  EXPECT_TRUE(found);
  for (const char* change : {"cycle.compare_point=heavy", "cycle.compare_by=rms"}) {
    const Ended refused =
        flexmorph(scratch, {"run", FLEXMORPH_TWO_PLATES, "-o", scratch / "other", "--set", change});
    EXPECT_EQ(refused.code, 2);
    EXPECT_NE(refused.err.find("compare_"), std::string::npos) << refused.err;
    EXPECT_FALSE(std::filesystem::exists(scratch / "other"));
  }
}

// Two designs with one budget of mass and three cycles: the run keeps the best cycle.
TEST(Run, KeepsTheBestOfItsCycles) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const Ended ended = flexmorph(scratch, {"run", FLEXMORPH_TWO_PLATES, "-o", folder});
  ASSERT_EQ(ended.code, kTooFew) << ended.err;
  const Table cycles = read_csv(folder + "/cycles.csv");
  ASSERT_EQ(cycles.size(), 7u);
  EXPECT_EQ(cycles[0], (Words{"cycle", "body", "compliance", "crisp_compliance", "design_change",
                              "measure", "best"}));
  const json run = run_json(folder);
  ASSERT_EQ(run["cycles"].size(), 3u);
  size_t best = 0;
  for (size_t r = 1; r < cycles.size(); ++r) {
    const Words& row = cycles[r];
    const json& cycle = run["cycles"][(r - 1) / 2];
    const json& body = cycle["bodies"][(r - 1) % 2];
    EXPECT_EQ(row[0], std::to_string(1 + (r - 1) / 2));
    EXPECT_EQ(row[1], r % 2 == 1 ? "heavy" : "light");
    EXPECT_EQ(row[1], body["body"].get<std::string>());
    EXPECT_EQ(std::stod(row[2]), body["compliance"]);
    EXPECT_EQ(std::stod(row[3]), body["crisp_compliance"]);
    EXPECT_EQ(std::stod(row[4]), body["design_change"]);
    EXPECT_GT(std::stod(row[4]), 0);
    EXPECT_EQ(std::stod(row[5]), cycle["measure"]);
    EXPECT_EQ(row[6] == "1", cycle["best"].get<bool>());
    if (row[6] == "1" && best == 0) best = r;
  }
  // The best cycle has the least strain energy, and the result is the design of this cycle.
  ASSERT_GT(best, 0u);
  for (size_t r = 1; r < cycles.size(); r += 2)
    EXPECT_GE(std::stod(cycles[r][5]), std::stod(cycles[best][5]));
  for (size_t b = 0; b < 2; ++b)
    EXPECT_EQ(run["results"][b]["compliance"], std::stod(cycles[best + b][2]));
  // The motion of this cycle was computed again for the tables.
  const Table motion = read_csv(folder + "/motion.csv");
  const auto strain = static_cast<size_t>(
      std::find(motion[0].begin(), motion[0].end(), "energy.strain") - motion[0].begin());
  ASSERT_LT(strain, motion[0].size());
  double integral = 0;  // trapezoidal rule
  for (size_t r = 2; r < motion.size(); ++r)
    integral += 0.5 * (std::stod(motion[r][0]) - std::stod(motion[r - 1][0])) *
                (std::stod(motion[r][strain]) + std::stod(motion[r - 1][strain]));
  EXPECT_NEAR(integral, std::stod(cycles[best][5]), 1e-3 * integral);

  EXPECT_NEAR(run["shared_mass"]["allowed"].get<double>(), 0.5 * 2700 * 0.05 * 0.015, 1e-12);
  EXPECT_LE(run["shared_mass"]["used"].get<double>(),
            run["shared_mass"]["allowed"].get<double>() * (1 + 1e-4));
  EXPECT_GT(run["results"][0]["volume"].get<double>(), run["results"][1]["volume"].get<double>());
  const std::string report = without_tags(contents_of(folder + "/report.html"));
  for (const char* column : {"strain energy is the best", "heavy: crisp compliance [J]"})
    EXPECT_TRUE(contains(report, column)) << column;
}

TEST(Run, WritesNothingTheSceneDidNotAskFor) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const Ended ended = flexmorph(
      scratch,
      short_run(folder, {"output.vtk=false", "output.plots=false", "optimizer.max_iterations=2"}));
  ASSERT_EQ(ended.code, kTooFew) << ended.err;
  for (const char* name : {"design", "motion", "plots"})
    EXPECT_FALSE(fs::exists(folder + "/" + name)) << name;
  EXPECT_TRUE(fs::exists(folder + "/history.csv"));
}

/// Returns the files of a folder that must not change from run to run, by their path in it.
std::map<std::string, std::string> lasting(const std::string& folder) {
  std::map<std::string, std::string> out;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    const std::string name = fs::relative(entry.path(), folder).string();
    if (name == "run.json" || name == "report.html" || name == ".flexmorph") continue;
    std::string text = contents_of(entry.path().string());
    if (name == "history.csv") {  // without the run times, which are the last seven columns
      std::string kept;
      for (Words row : read_csv(entry.path().string())) {
        row.resize(row.size() - 7);
        for (const std::string& cell : row) kept += cell + ",";
        kept += "\n";
      }
      text = kept;
    }
    out[name] = text;
  }
  return out;
}

TEST(Run, RepeatsItselfByteForByte) {
  const Scratch scratch;
  const std::string first = scratch / "first", second = scratch / "second";
  ASSERT_EQ(flexmorph(scratch, short_run(first)).code, kTooFew);
  // The second folder first contains another run with frames of two more iterations; none of its
  // files may remain.
  ASSERT_EQ(flexmorph(scratch, short_run(second, {"optimizer.max_iterations=8",
                                                  "output.plots=false", "time.end=0.04"}))
                .code,
            kTooFew);
  ASSERT_EQ(flexmorph(scratch, short_run(second)).code, kTooFew);
  const auto a = lasting(first), b = lasting(second);
  EXPECT_GT(a.size(), 25u);
  EXPECT_TRUE(a.contains("motion.csv") && a.contains("history.csv"));
  for (const auto& [name, text] : a) {
    ASSERT_TRUE(b.contains(name)) << name;
    EXPECT_TRUE(b.at(name) == text) << name;
  }
  EXPECT_EQ(a.size(), b.size());
}

// A hub that suddenly turns 16000 times per second destroys the plate within a few steps.
TEST(Run, AFailureKeepsWhatCameBefore) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const Ended ended = flexmorph(
      scratch, short_run(folder, {"hub.angular_velocity=1e5", "time.start=rigid", "time.step=0.12",
                                  "body.elements=[5, 1]", "body.flow.max_length=0.3"}));
  EXPECT_EQ(ended.code, 3) << ended.out;
  EXPECT_TRUE(starts(ended.err, "flexmorph: "));
  const json run = run_json(folder);
  EXPECT_EQ(run["status"], "failed");
  const std::string message = run["message"];
  EXPECT_TRUE(contains(message, "step "));
  EXPECT_TRUE(contains(message, "t = "));
  EXPECT_TRUE(contains(ended.err, message));
  const Table motion = read_csv(folder + "/motion.csv");
  ASSERT_GE(motion.size(), 3u);
  EXPECT_EQ(motion[1][0], "0");
  for (size_t r = 1; r < motion.size(); ++r) EXPECT_EQ(motion[r].size(), motion[0].size());
  EXPECT_TRUE(fs::exists(folder + "/report.html"));
  EXPECT_TRUE(fs::exists(folder + "/case.toml"));
}

/// Waits until a file has a number of lines.
bool has_lines(const ChildProgram& run, const std::string& path, size_t n) {
  return eventually(run, [&] { return lines_of(contents_of(path)).size() >= n; });
}

TEST(Run, AnInterruptionKeepsWhatWasComputed) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  testing::ChildProgram child = start(
      scratch, short_run(folder, {"optimizer.max_iterations=100000", "optimizer.kkt_tolerance=0"}));
  ASSERT_TRUE(has_lines(child, folder + "/history.csv", 4));
  child.send(SIGINT);
  const Ended ended = child.end();
  EXPECT_EQ(ended.code, 4) << ended.err;
  const json run = run_json(folder);
  EXPECT_EQ(run["status"], "interrupted");
  // The last line is the end of a command that a shell can read, which continues the run.
  const std::string said =
      ended.out.substr(std::min(ended.out.size(), ended.out.rfind("flexmorph run")));
  EXPECT_TRUE(testing::mentions_all(said, {FLEXMORPH_SHORT_CASE, "--set optimizer.kkt_tolerance=0",
                                           "-o " + folder, "--resume\n"}));
  const Table history = read_csv(folder + "/history.csv");
  expect_history(history);
  const std::string index = contents_of(folder + "/design/iterations.pvd");
  EXPECT_EQ(static_cast<size_t>(count(index, "<DataSet ")), history.size() - 1);
  // The best design so far and the motion of its loads are written.
  ASSERT_EQ(run["results"].size(), 1u);
  EXPECT_GT(run["results"][0]["crisp_compliance"].get<double>(), 0);
  EXPECT_EQ(read_csv(folder + "/components.csv").size(), 25u);
  expect_motion(read_csv(folder + "/motion.csv"));
  EXPECT_TRUE(fs::exists(folder + "/report.html"));
}

TEST(Run, AnInterruptionOfTheMotionKeepsItsSteps) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  testing::ChildProgram child = start(scratch, short_run(folder, {"time.step=1e-6"}));
  ASSERT_TRUE(has_lines(child, folder + "/motion.csv", 3));
  child.send(SIGINT);
  const Ended ended = child.end();
  EXPECT_EQ(ended.code, 4) << ended.err;
  EXPECT_EQ(run_json(folder)["status"], "interrupted");
  const Table motion = read_csv(folder + "/motion.csv");
  ASSERT_GE(motion.size(), 2u);  // the start, and the steps before the interruption
  EXPECT_LT(std::stod(motion.back()[0]), 0.12);
}

}  // namespace
}  // namespace flexmorph::test
