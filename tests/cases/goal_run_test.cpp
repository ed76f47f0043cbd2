// Designs with other goals than the shipped ones, as the program runs them: they keep to their
// limits, and tables, run.json and report say what came out.

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "io/tables.h"
#include "tests/cases/program.h"

namespace flexmorph::test {
namespace {

/// short_beam on 20 x 10 cells, 2000 kg when it is full.
nlohmann::json run_beam(const Scratch& scratch, const std::string& folder, Words changes,
                        int code = 0) {
  changes.insert(changes.begin(), {"design.cell=0.1", "design.min_thickness=0.1",
                                   "domain.density=1000.0", "design.max_volume="});
  const Ended ended = run(scratch, "short_beam", folder, changes);
  EXPECT_EQ(ended.code, code) << ended.err;
  return nlohmann::json::parse(contents_of(folder + "/run.json"));
}

TEST(GoalRun, TheLightestPlateThatIsStiffEnough) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const nlohmann::json run =
      run_beam(scratch, folder,
               {"design.minimize=mass", "design.max_compliance=80.0", "optimizer.max_iterations=60",
                "design.cell=0.05", "design.min_thickness=0.05"});
  const nlohmann::json& body = run["results"][0];
  // Of nothing but the widths of an outline on twenty cells, and what these fuse.
  for (const std::string warning : run["warnings"])
    EXPECT_TRUE(warning.find("'beam', its outline: ") != std::string::npos ||
                warning.find("': the cells of the design say") != std::string::npos)
        << warning;
  EXPECT_LE(body["compliance"].get<double>(), 80 * (1 + 1e-3));
  EXPECT_NEAR(body["mass"].get<double>(), 2000 * body["volume"].get<double>(), 1e-9);
  EXPECT_NEAR(body["sharp_mass"].get<double>(), 2000 * body["sharp_volume"].get<double>(), 1e-9);
  EXPECT_LT(body["mass"].get<double>(), 0.5 * 2000);
  // The limit is that of the smoothed design, whose compliance lies 7 % above that of its outline.
  EXPECT_LE(body["body_fitted"]["compliance"].get<double>(), 80);
  const io::CsvTable history = io::read_csv(folder + "/history.csv");
  const std::vector<double> mass = history.numbers("mass"), volume = history.numbers("volume"),
                            objective = history.numbers("scaled_objective");
  ASSERT_GT(mass.size(), 10u);
  for (size_t k = 0; k < mass.size(); ++k) {
    EXPECT_NEAR(mass[k], 2000 * volume[k], 1e-9);
    EXPECT_NEAR(objective[k], volume[k], 1e-12);  // in parts of the full mass
  }
  const std::string report = contents_of(folder + "/report.html");
  EXPECT_NE(report.find("mass [kg]"), std::string::npos);
}

// Of no interest to anybody, but a whole run without one state solved for its design: as much as is
// wanted, and no more.
TEST(GoalRun, WithoutAStateNoneIsSolved) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const nlohmann::json run =
      run_beam(scratch, folder,
               {"design.minimize=volume", "optimizer.max_iterations=30", "output.sharp_every=0",
                "output.vtk=false", "design.constraint=[{response='mass', at_least=900.0}]"},
               5);  // nothing asks it to join what is held and what is loaded
  const nlohmann::json& body = run["results"][0];
  EXPECT_NEAR(body["mass"].get<double>(), 900, 10);
  EXPECT_GT(body["compliance"].get<double>(), 0);
  // Of the design when it was done: blurred, sharp, and spread evenly.
  EXPECT_LE(body["factorizations"].get<int>(), 4);
  const io::CsvTable history = io::read_csv(folder + "/history.csv");
  for (const std::string& cell : history.texts("compliance")) EXPECT_EQ(cell, "");
}

// A limit that no design keeps to is warned of.
TEST(GoalRun, SaysWhatIsNotKept) {
  const Scratch scratch;
  const nlohmann::json run = run_beam(
      scratch, scratch / "out",
      {"design.minimize=volume", "design.max_compliance=1.0", "optimizer.max_iterations=5"});
  const std::string warnings = run["warnings"].dump();
  EXPECT_NE(warnings.find("the summed compliance"), std::string::npos) << warnings;
  EXPECT_NE(warnings.find("is above what is allowed, 1: no design"), std::string::npos) << warnings;
}

// A design that joins nothing ends as what it is: on the screen, in its exit code, first in the
// report and in the tables of a study.
TEST(GoalRun, SaysWhatNobodyCanUse) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const std::string start = scratch.write(
      "short_of_the_load.csv", "X0,Y0,half_length,angle,c1,c2,c3\n0.4,0.5,0.4,0,0.1,0.1,0.1\n");
  const Words changes = {"design.cell=0.1", "design.min_thickness=0.1",
                         "design.start='" + start + "'", "optimizer.max_iterations=1", "expect="};
  const Ended ended = run(scratch, "short_beam", folder, changes);
  EXPECT_EQ(ended.code, 5);
  const auto json = nlohmann::json::parse(contents_of(folder + "/run.json"));
  EXPECT_EQ(json["status"], "done, not usable");
  const std::string words = "no piece of material joins what is held and what is loaded";
  EXPECT_NE(ended.err.find("flexmorph: not usable: body 'beam': " + words), std::string::npos)
      << ended.err;
  const std::string counted = ", " + std::to_string(json["warnings"].size()) + " warnings: ";
  EXPECT_NE(ended.out.find("done, not usable" + counted + folder), std::string::npos) << ended.out;
  const std::string report = contents_of(folder + "/report.html");
  EXPECT_LT(report.find(words), report.find("<table")) << "first in the report";
}

}  // namespace
}  // namespace flexmorph::test
