// Shows that designs with other goals than those of the shipped cases keep their limits, and that
// tables, run.json and the report describe the results.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <regex>

#include "io/files.h"
#include "io/tables.h"
#include "tests/cases/program.h"
#include "tests/cases/run_json.h"
#include "tests/support/errors.h"

namespace flexmorph::test {
namespace {

/// Runs short_beam on 20 x 10 cells; the full plate has 2000 kg.
json run_beam(const Scratch& scratch, const std::string& folder, Words changes, int code = 0) {
  changes.insert(changes.begin(), {"design.cell=0.1", "design.min_thickness=0.1",
                                   "domain.density=1000.0", "design.max_volume="});
  const Ended ended = run(scratch, "short_beam", folder, changes);
  EXPECT_EQ(ended.code, code) << ended.err;
  return run_json(folder);
}

/// Designs the lightest plate whose compliance is at most 80 J.
void expect_lightest(const std::string& min_feature) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const json run =
      run_beam(scratch, folder,
               {"design.minimize=mass", "design.max_compliance=80.0", "optimizer.max_iterations=60",
                "design.cell=0.05", "design.min_thickness=0.05",
                "design.min_feature=" + min_feature, "output.vtk=false"});
  const json& body = run["results"][0];
  // Only two warnings are allowed: about the widths of an outline on twenty cells, and about gaps
  // that these widths close.
  for (const std::string warning : run["warnings"])
    EXPECT_TRUE(testing::mentions_all(warning, {"outline", "'beam'", "narrower"}) ||
                testing::mentions_all(warning, {"'beam'", "body-fitted compliance"}))
        << warning;
  // The limit refers to the crisp design and is active.
  EXPECT_NEAR(body["crisp_compliance"].get<double>(), 80, 5e-3 * 80);
  EXPECT_NEAR(body["mass"].get<double>(), 2000 * body["volume"].get<double>(), 1e-9);
  EXPECT_NEAR(body["crisp_mass"].get<double>(), 2000 * body["crisp_volume"].get<double>(), 1e-9);
  EXPECT_LT(body["mass"].get<double>(), 0.5 * 2000);
  const io::CsvTable history = io::read_csv(folder + "/history.csv");
  const std::vector<double> mass = history.numbers("mass"), volume = history.numbers("volume"),
                            objective = history.numbers("scaled_objective");
  ASSERT_GT(mass.size(), 10u);
  for (size_t k = 0; k < mass.size(); ++k) {
    EXPECT_NEAR(mass[k], 2000 * volume[k], 1e-9);
    EXPECT_NEAR(objective[k], volume[k], 1e-12);  // the objective is the fraction of the full mass
  }
  const std::string report = contents_of(folder + "/report.html");
  EXPECT_NE(report.find("mass <span class=\"unit\">[kg]</span>"), std::string::npos);
}

TEST(GoalRun, TheLightestPlateThatIsStiffEnough) { expect_lightest("0"); }

// The minimum width, two times the least thickness by default, is a constraint.
TEST(LongGoalRun, TheLightestPlateOfWideFeaturesThatIsStiffEnough) { expect_lightest("0.1"); }

// If a design of 40 % volume reaches a compliance, then the least volume with this compliance is
// about 40 % or less.
TEST(GoalRun, VolumeUnderComplianceIsTheInverseOfComplianceUnderVolume) {
  const Scratch scratch;
  const Words mesh = {"design.cell=0.05",     "design.min_thickness=0.05",
                      "design.min_feature=0", "optimizer.max_iterations=60",
                      "output.vtk=false",     "output.plots=false"};
  const auto designed = [&](const std::string& folder, Words changes) {
    changes.insert(changes.end(), mesh.begin(), mesh.end());
    const Ended ended = run(scratch, "short_beam", scratch / folder, changes);
    EXPECT_TRUE(is_done(ended, scratch / folder));
    return run_json(scratch / folder)["results"][0];
  };
  const json stiff = designed("stiff", {"expect="});
  const double compliance = stiff["crisp_compliance"];
  // The stiff design has the permitted compliance, so that no trajectory has to find a better one.
  const json light =
      designed("light", {"expect=", "design.max_volume=", "design.minimize=volume",
                         "design.max_compliance=" + io::to_text(compliance),
                         "design.start='" + (scratch / "stiff/components.csv") + "'"});
  // A limit on the compliance of the crisp design holds within 0.5 %.
  constexpr double kPermitted = 1 + 5e-3;
  EXPECT_LE(light["crisp_compliance"].get<double>(), kPermitted * compliance);
  EXPECT_LE(light["crisp_volume"].get<double>(), kPermitted * stiff["crisp_volume"].get<double>());
}

// Under given loads the full plate has the least compliance.
TEST(GoalRun, RefusesALimitThatTheFullPlateMisses) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const auto ended = [&](const std::string& limit) {
    return run(scratch, "short_beam", folder,
               {"design.cell=0.1", "design.min_thickness=0.1",
                "design.max_volume=", "design.minimize=volume", "design.max_compliance=" + limit,
                "optimizer.max_iterations=1"});
  };
  const Ended refused = ended("30.0");
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.err.find("design.max_compliance=30"), std::string::npos) << refused.err;
  EXPECT_FALSE(std::filesystem::exists(folder));
  // Reference: a Timoshenko beam of length 2 and height 1, clamped at one end, C = F u.
  const double beam = 8 / (3 * (1. / 12)) + 2 / (5. / 6 / 2.6);
  std::smatch found;  // the only number with this unit is the compliance of the full domain
  ASSERT_TRUE(std::regex_search(refused.err, found, std::regex("([0-9.]+) J"))) << refused.err;
  EXPECT_NEAR(std::stod(found[1]), beam, 0.1 * beam);
  EXPECT_NE(ended("60.0").code, 2);
}

// The designs are given: bars from the left edge to the load, or a bar that does not reach the
// supports. In the first design the second support holds no loaded material; in the second one
// nothing connects the load to a support.
TEST(GoalRun, NamesWhatTheDesignDoesNotUse) {
  const Scratch scratch;
  const auto words = [&](const std::string& bars, int code) {
    io::write_file(scratch / "bars.csv", "X0,Y0,half_length,angle,c1,c2,c3\n" + bars);
    const Ended ended = run(scratch, FLEXMORPH_UNUSED_SUPPORT, scratch / "out",
                            {"design.start=\"" + (scratch / "bars.csv") + "\""});
    EXPECT_EQ(ended.code, code) << ended.err;
    return ended.err;
  };
  EXPECT_TRUE(testing::mentions_all(words("0.3,0.5,0.4,0,0.1,0.1,0.1\n", 0),
                                    {"connects", "support 2", "load"}));
  EXPECT_TRUE(testing::mentions_all(words("1.5,0.5,0.2,0,0.1,0.1,0.1\n", 5),
                                    {"not usable", "connects", "load", "support"}));
}

// A goal without any state response must run without state solutions during the iterations.
TEST(GoalRun, WithoutAStateNoneIsSolved) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const json run = run_beam(scratch, folder,
                            {"design.minimize=volume", "optimizer.max_iterations=30",
                             "output.crisp_every=0", "output.vtk=false", "design.min_feature=0",
                             "design.constraint=[{response='mass', at_least=900.0}]"},
                            5);  // nothing requires it to connect supports and loads
  const json& body = run["results"][0];
  EXPECT_NEAR(body["mass"].get<double>(), 900, 10);
  EXPECT_GT(body["compliance"].get<double>(), 0);
  // Only the final design is solved: smoothed, crisp, and with uniformly distributed material.
  EXPECT_LE(body["factorizations"].get<int>(), 4);
  const io::CsvTable history = io::read_csv(folder + "/history.csv");
  for (const std::string& cell : history.texts("compliance")) EXPECT_EQ(cell, "");
}

// Two limits that contradict each other give a design that is not usable.
TEST(GoalRun, SaysWhatIsNotKept) {
  const Scratch scratch;
  const json run =
      run_beam(scratch, scratch / "out",
               {"design.minimize=volume", "optimizer.max_iterations=5",
                "design.constraint=[{response='compliance', at_most=45.0}, {response='mass', "
                "at_most=200.0}]"},
               5);
  const auto found =
      std::any_of(run["warnings"].begin(), run["warnings"].end(), [](const std::string warning) {
        return static_cast<bool>(testing::mentions_all(warning, {"'beam'", "compliance", "45"})) ||
               static_cast<bool>(testing::mentions_all(warning, {"'beam'", "mass", "200"}));
      });
  EXPECT_TRUE(found) << run["warnings"];
}

// A design that connects nothing is reported as not usable: on the screen, by the exit code, and at
// the beginning of the report.
TEST(GoalRun, SaysWhatNobodyCanUse) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const std::string start = scratch.write(
      "short_of_the_load.csv", "X0,Y0,half_length,angle,c1,c2,c3\n0.4,0.5,0.4,0,0.1,0.1,0.1\n");
  const Words changes = {"design.cell=0.1", "design.min_thickness=0.1",
                         "design.start='" + start + "'", "optimizer.max_iterations=1", "expect="};
  const Ended ended = run(scratch, "short_beam", folder, changes);
  EXPECT_EQ(ended.code, 5);
  const json written = run_json(folder);
  EXPECT_EQ(written["status"], "done, not usable");
  const Words told = lines_of(ended.err);
  const auto named = std::find_if(told.begin(), told.end(), [](const std::string& line) {
    return static_cast<bool>(testing::mentions_all(
        line, {"'beam'", "connects", "load 'tip'", "support"}, "flexmorph: not usable: "));
  });
  ASSERT_NE(named, told.end()) << ended.err;
  const std::string counted = std::to_string(written["warnings"].size()) + " warnings";
  ASSERT_FALSE(ended.out.empty());
  EXPECT_TRUE(testing::mentions_all(
      lines_of(ended.out).back(), {"volume fraction 0.0", counted, folder}, "done, not usable: "));
  const std::string report = contents_of(folder + "/report.html");
  EXPECT_NE(without_tags(report.substr(0, report.find("<main>")))
                .find(named->substr(named->find("'beam'"))),
            std::string::npos)
      << "first in the report";
}

}  // namespace
}  // namespace flexmorph::test
