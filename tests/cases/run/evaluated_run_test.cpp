// Shows that `optimizer.max_iterations = 0` evaluates a given design: the run has all numbers and
// files of a run whose optimizer has hardly moved the design.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <set>

#include "io/tables.h"
#include "tests/cases/program.h"
#include "tests/cases/run_json.h"
#include "tests/support/errors.h"

namespace flexmorph::test {
namespace {

struct Runs {
  json evaluated, optimized;  // run.json
  std::string folder;         // folder of the evaluated run
};

/// Runs a case with a given design two times: evaluated, and with one iteration that may move a
/// variable by 1e-9 of its range. Files that only iterations write may be missing in the first run.
Runs run_both(const Scratch& scratch, const std::string& name, const std::string& design,
              Words changes) {
  changes.insert(changes.end(), {"design.start='" + design + "'", "design.min_feature=0"});
  Runs out;
  std::set<std::string> files[2];
  for (const int iterations : {0, 1}) {
    const std::string folder = scratch / ("run_" + std::to_string(iterations));
    Words all = changes;
    all.insert(all.end(), {"optimizer.max_iterations=" + std::to_string(iterations),
                           "optimizer.move_limit=1e-9", "output.design_every=0"});
    const Ended ended = run(scratch, name, folder, all);
    EXPECT_TRUE(is_done(ended, folder));
    json& found = iterations == 0 ? out.evaluated : out.optimized;
    found = run_json(folder);
    EXPECT_EQ(found["status"] == "done", ended.code == 0) << found["status"];
    if (iterations == 0) out.folder = folder;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
      files[iterations].insert(std::filesystem::relative(entry.path(), folder).string());
  }
  for (const std::string& file : files[1])
    EXPECT_TRUE(files[0].contains(file) || file == "history.csv" ||
                file.starts_with("plots/convergence"))
        << file;
  EXPECT_EQ(out.evaluated["status"], out.optimized["status"]);
  const json& result = out.evaluated["results"][0];
  EXPECT_EQ(result["verdict"], "evaluated");
  EXPECT_TRUE(testing::mentions_all(result["stop"], {"not optimized"}));
  EXPECT_GT(result["kkt"].get<double>(), 0);
  return out;
}

/// Compares numbers that both runs have. Changes of 1e-9 of the variables affect the sampled area
/// fractions of a few cells at most.
void expect_same(const json& evaluated, const json& optimized, const Words& names) {
  for (const std::string& name : names) {
    ASSERT_TRUE(evaluated.contains(name)) << name;
    const double value = optimized[name].get<double>();
    EXPECT_NEAR(evaluated[name].get<double>(), value, 1e-5 * std::abs(value)) << name;
  }
}

TEST(EvaluatedRun, OfAPlateAtRestIsThatOfAnOptimizedOne) {
  const Scratch scratch;
  const Runs runs = run_both(scratch, "short_beam", FLEXMORPH_DATA "/short_beam.csv", {});
  const json &a = runs.evaluated["results"][0], &b = runs.optimized["results"][0];
  expect_same(a, b,
              {"compliance", "volume", "crisp_compliance", "crisp_volume", "uniform_compliance",
               "min_feature", "min_gap", "worst_compliance"});
  EXPECT_EQ(a["connected"], b["connected"]);
  EXPECT_EQ(a["islands"], b["islands"]);
  expect_same(a["body_fitted"], b["body_fitted"], {"compliance", "volume", "largest_stress"});
  expect_same(a["load_cases"][0], b["load_cases"][0],
              {"strain_energy", "largest_displacement", "largest_stress"});
}

// A given design has shorter and thicker bars than the bounds of a start design allow. They are not
// changed except by rounding, because variables are scaled.
TEST(EvaluatedRun, TakesADesignAsItsFileHasIt) {
  const Scratch scratch;
  const std::string rows =
      "X0,Y0,half_length,angle,c1,c2,c3\n"
      "1,0.15,1,0,0.1500001,0.15,0.1500002\n"
      "1,0.85,1,0,0.15,0.15,0.15\n"
      "1,0.5,0.01,1.5,0.011,0.013,0.012\n";
  const std::string bars = scratch.write("bars.csv", rows), folder = scratch / "run";
  const Ended ended =
      run(scratch, "short_beam", folder,
          {"design.start='" + bars + "'", "optimizer.max_iterations=0", "design.min_thickness=0.02",
           "design.half_length=0.2", "design.cell=0.05", "output.vtk=false", "output.plots=false"});
  EXPECT_TRUE(is_done(ended, folder));
  const io::CsvTable given = io::read_csv(bars), found = io::read_csv(folder + "/components.csv");
  ASSERT_EQ(found.columns, given.columns);
  ASSERT_EQ(found.n_rows(), given.n_rows());
  for (const std::string& column : given.columns) {
    const std::vector<double> is = found.numbers(column), was = given.numbers(column);
    for (size_t k = 0; k < was.size(); ++k)
      EXPECT_NEAR(is[k], was[k], 1e-15 * std::abs(was[k])) << column;
  }
}

TEST(EvaluatedRun, OfAMotionIsThatOfAnOptimizedOne) {
  const Scratch scratch;
  // Two bars side by side: the full plate without its corners.
  const std::string bars = scratch.write("bars.csv",
                                         "X0,Y0,half_length,angle,c1,c2,c3\n"
                                         "0.265,-0.025,0.29,0,0.02,0.02,0.02\n"
                                         "0.265,0.025,0.29,0,0.02,0.02,0.02\n");
  const Runs runs = run_both(
      scratch, FLEXMORPH_SHORT_CASE, bars,
      {"observe=[{name='end', body='plate', at='free_end'}]", "verify={refine=2, step=2e-3}",
       "time.end=0.06", "design.cell=0.01", "design.min_thickness=0.01", "esl.every=0.02"});
  const json &a = runs.evaluated["results"][0], &b = runs.optimized["results"][0];
  expect_same(a, b,
              {"crisp_compliance", "uniform_compliance", "dynamic_amplitude",
               "uniform_dynamic_amplitude", "scene_mesh_amplitude"});
  expect_same(a["body_fitted"], b["body_fitted"], {"compliance", "volume"});
  expect_same(a["load_difference"], b["load_difference"], {"geometric"});
  EXPECT_NEAR(a["load_difference"]["loads"].get<double>(), 0, 1e-9);
  expect_same(runs.evaluated["motion"], runs.optimized["motion"],
              {"strain_energy_integral", "uniform_strain_energy_integral", "energy_error"});
  const Words numbers = {"mean",       "rms",       "peak_to_peak",       "largest",
                         "mean_ratio", "rms_ratio", "peak_to_peak_ratio", "largest_ratio"};
  expect_same(a["tip"], b["tip"], numbers);
  // The observed point is the tip, whose deflection also has a column of its own.
  ASSERT_EQ(a["points"].size(), 1u);
  EXPECT_EQ(a["points"][0]["point"], "end");
  for (const std::string& name : numbers)
    EXPECT_NEAR(a["points"][0][name].get<double>(), a["tip"][name].get<double>(),
                1e-9 * std::abs(a["tip"][name].get<double>()))
        << name;
  const io::CsvTable motion = io::read_csv(runs.folder + "/motion.csv");
  const std::vector<double> across = motion.numbers("plate.end_across"),
                            tip = motion.numbers("plate.tip_deflection");
  ASSERT_EQ(across.size(), tip.size());
  for (size_t k = 0; k < tip.size(); ++k) EXPECT_NEAR(across[k], tip[k], 1e-14);
}

/// Returns motion.csv of the first steps of a case whose body is a few crossing bars.
io::CsvTable first_steps(const Scratch& scratch, const std::string& name, Words changes) {
  const std::string folder = scratch / name;
  changes.insert(changes.end(), {"optimizer.max_iterations=0", "verify=", "cycle=", "time.end=0.03",
                                 "esl.every=0.01", "design.cell=0.005", "design.components=[4, 1]",
                                 "design.half_length=0.075", "design.min_thickness=0.008",
                                 "output.vtk=false", "output.plots=false"});
  const Ended ended = run(scratch, name, folder, changes);
  EXPECT_TRUE(is_done(ended, folder));
  return io::read_csv(folder + "/motion.csv");
}

// The rocker is welded to a shaft and extends along the shaft's first axis: displacements across it
// are measured in the axes of the shaft.
TEST(PointsAcross, OfAWeldedBodyAreInTheAxesOfItsCarrier) {
  const Scratch scratch;
  const io::CsvTable motion = first_steps(scratch, "four_bar", {});
  const std::vector<double> x = motion.numbers("rocker.tip_x"), y = motion.numbers("rocker.tip_y"),
                            across = motion.numbers("rocker.tip_across"),
                            shaft_x = motion.numbers("shaft.x"),
                            shaft_y = motion.numbers("shaft.y"),
                            angle = motion.numbers("shaft.angle");
  ASSERT_GT(across.size(), 20u);
  double largest = 0;
  for (size_t k = 0; k < across.size(); ++k) {
    const double expected =
        std::cos(angle[k]) * (y[k] - shaft_y[k]) - std::sin(angle[k]) * (x[k] - shaft_x[k]);
    EXPECT_NEAR(across[k], expected, 1e-9);
    largest = std::max(largest, std::abs(expected));
  }
  EXPECT_GT(largest, 1e-7);
}

// A connecting rod is measured from the line between its pins: the distance of its middle from
// their chord.
TEST(PointsAcross, OfALinkAreCountedFromTheLineOfItsPins) {
  const Scratch scratch;
  const io::CsvTable motion =
      first_steps(scratch, "slider_crank_designed",
                  {"design.band=[1.5]", "design.min_feature=0.005",
                   "observe=[{name='a', body='rod', point=[0.025, 0.0]}, {name='b', body='rod', "
                   "point=[0.575, 0.0]}, {name='middle', body='rod', point=[0.3, 0.0]}]"});
  const auto column = [&](const std::string& name) { return motion.numbers("rod." + name); };
  const std::vector<double> ax = column("a_x"), ay = column("a_y"), bx = column("b_x"),
                            by = column("b_y"), x = column("middle_x"), y = column("middle_y"),
                            across = column("middle_across");
  ASSERT_GT(across.size(), 20u);
  double largest = 0;
  for (size_t k = 0; k < across.size(); ++k) {
    const double length = std::hypot(bx[k] - ax[k], by[k] - ay[k]);
    const double expected =
        ((bx[k] - ax[k]) * (y[k] - ay[k]) - (by[k] - ay[k]) * (x[k] - ax[k])) / length;
    EXPECT_NEAR(across[k], expected, 1e-9);
    largest = std::max(largest, std::abs(expected));
  }
  EXPECT_GT(largest, 1e-8);
}

}  // namespace
}  // namespace flexmorph::test
