// Shows that numbers are written with full precision: read back from tables and run.json they equal
// the computed doubles bit for bit.
#include <gtest/gtest.h>

#include <filesystem>

#include "cases/check/ready.h"
#include "cases/output/report.h"
#include "cases/run/motion_run.h"
#include "io/drawings/exports.h"
#include "tests/cases/program.h"
#include "tests/cases/run_json.h"

namespace flexmorph::cases {
namespace {

using nlohmann::json;

/// A scene and a run folder for it.
struct Case {
  Case(const Scratch& scratch, const std::string& name, const test::Words& changes)
      : file(find_case(name), changes), scene(read_scene(file)), folder(scratch / "out", scene) {}

  io::CsvTable table(const std::string& name) const {
    return io::read_csv(folder.path() + "/" + name);
  }
  json run_json() const { return test::run_json(folder.path()); }

  io::CaseFile file;
  Scene scene;
  RunFolder folder;
};

void expect_column(const io::CsvTable& table, const std::string& name,
                   const std::vector<double>& computed) {
  const std::vector<double> read = table.numbers(name);
  ASSERT_EQ(read.size(), computed.size()) << name;
  for (size_t i = 0; i < read.size(); ++i) EXPECT_EQ(read[i], computed[i]) << name << " " << i;
}

void expect_motion(const io::CsvTable& table, const MotionRecord& motion) {
  ASSERT_EQ(table.columns.size(), motion.table.columns.size());
  for (size_t c = 0; c < motion.table.columns.size(); ++c)
    expect_column(table, motion.table.columns[c].name, motion.table.values[c]);
}

TEST(RoundTrip, Motion) {
  for (const char* name : {FLEXMORPH_SHORT_CASE, "slider_crank_heated"}) {
    const Scratch scratch;
    Case c(scratch, name, {"time.end=0.02"});
    RunResult result;
    result.motions.motion = run_motion(PreparedCase(c.scene), {}, &c.folder).record;
    const MotionRecord& motion = *result.motions.motion;
    ASSERT_EQ(motion.table.n_rows(), 21u);
    expect_motion(c.table("motion.csv"), motion);
    write_report(c.scene, result, c.folder);
    const json run = c.run_json()["motion"];
    EXPECT_GT(motion.result.energy_error, 0);
    EXPECT_EQ(run["energy_error"].get<double>(), motion.result.energy_error);
    EXPECT_EQ(run["velocity_drift"].get<double>(), motion.result.velocity_drift);
    EXPECT_EQ(run["smallest_area_ratio"].get<double>(), motion.result.smallest_area_ratio);
    for (const size_t c : motion.table.of_group(ColumnGroup::observed))
      EXPECT_EQ(run["observed"][motion.table.columns[c].name].get<double>(),
                motion.table.values[c].back());
  }
}

TEST(RoundTrip, Design) {
  const Scratch scratch;
  Case c(scratch, "short_beam", {"design.cell=0.1", "optimizer.max_iterations=8"});
  RunResult run;
  run.design.problems = build_problems(c.scene);
  mmc::BodyProblem& problem = run.design.problems.front();
  const auto loads = build_static_loads(c.scene, problem);
  std::vector<double> compliance, volume, kkt, change;
  bool is_running = true;
  run.design.outcomes = {mmc::design_body(
      problem, *loads, 1, {0, c.scene.optimizer},
      [&](const mmc::IterationReport& r) {
        c.folder.add_iteration(r);
        compliance.push_back(r.state.compliance());
        volume.push_back(r.state.volume());
        kkt.push_back(r.iterate.kkt);
        change.push_back(r.iterate.change);
        return true;
      },
      is_running)};
  ASSERT_EQ(compliance.size(), 8u);
  const io::CsvTable history = c.table("history.csv");
  expect_column(history, "compliance", compliance);
  expect_column(history, "volume", volume);
  expect_column(history, "kkt", kkt);
  expect_column(history, "change", change);

  const mmc::BodyOutcome& outcome = run.design.outcomes.front();
  c.folder.write_design(problem, outcome);
  const auto components = io::read_components_csv(c.folder.path() + "/components.csv");
  ASSERT_EQ(components.size(), problem.design.components().size());
  for (size_t i = 0; i < components.size(); ++i)
    EXPECT_EQ(components[i].parameters(), problem.design.components()[i].parameters()) << i;

  write_report(c.scene, run, c.folder);
  const json result = c.run_json()["results"][0];
  for (const auto& [key, value] : std::initializer_list<std::pair<const char*, double>>{
           {"compliance", outcome.compliance},
           {"volume", outcome.volume},
           {"crisp_compliance", outcome.crisp.compliance},
           {"uniform_compliance", outcome.uniform_compliance}})
    EXPECT_EQ(result[key].get<double>(), value) << key;
}

// A solid that could not be made for the design of an earlier cycle is no longer missing when that
// of the last cycle exists.
TEST(RunFolder, MissesTheExportsOfTheLastDesignOnly) {
  const Scratch scratch;
  Case c(scratch, "short_beam", {"design.cell=0.1", "output.plots=false"});
  std::vector<mmc::BodyProblem> problems = build_problems(c.scene);
  mmc::BodyProblem& problem = problems.front();
  mmc::BodyOutcome outcome;
  outcome.crisp.fractions = VectorXd::Zero(problem.grid.n_cells());
  const auto has_solid = [&] { return std::filesystem::exists(c.folder.path() + "/design.step"); };
  const Region crossed{{{0.0, 0.0}, {1.0, 1.0}, {1.0, 0.0}, {0.0, 1.0}}, {}};
  problem.part = std::vector<Region>{crossed};  // its sides cross: no solid
  c.folder.write_design(problem, outcome);
  EXPECT_NE(c.folder.missing_exports().find("design.step"), std::string::npos);
  EXPECT_FALSE(has_solid());
  problem.part = std::vector<Region>{{{{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}, {}}};
  c.folder.write_design(problem, outcome);
  EXPECT_EQ(c.folder.missing_exports(), "");
  EXPECT_TRUE(has_solid());
  problem.part = std::vector<Region>{crossed};
  c.folder.write_design(problem, outcome);
  EXPECT_FALSE(has_solid());  // it would be the solid of another design
}

}  // namespace
}  // namespace flexmorph::cases
