// Shows that the design problems of a case are those of its run: values at the start, and designs
// after all stages; that folders of compute_into() are those of the program; and that drives can be
// registered.
#include "cases/run/design_problem.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "cases/run/compute.h"
#include "tests/cases/program.h"
#include "tests/cases/run_json.h"
#include "tests/cases/scenes.h"
#include "tests/support/errors.h"

namespace flexmorph::cases {
namespace {

const Changes kSmall{"design.cell=0.1", "design.min_thickness=0.1", "optimizer.max_iterations=4",
                     "output.plots=false", "output.vtk=false"};

TEST(DesignProblems, HaveTheValuesAndDesignsOfARun) {
  for (const auto& [name, changes] :
       {std::pair{std::string(FLEXMORPH_SHORT_CASE), Changes{}}, {"short_beam", kSmall}}) {
    const PreparedCase prepared = load_case(name, changes);
    std::vector<double> objectives;
    ComputeSettings settings;
    settings.iteration = [&](const mmc::IterationReport& r) {
      objectives.push_back(r.iterate.response->f);
    };
    const RunResult run = compute(prepared, settings);
    DesignProblem problem(prepared, {.stage = DesignStage::coarse});
    const VectorXd start = problem.problem().start();
    EXPECT_EQ(problem.problem().evaluate(start).f, objectives.front());
    EXPECT_EQ(problem.variable_names().size(), static_cast<size_t>(start.size()));
    EXPECT_EQ(problem.constraint_names().size(),
              static_cast<size_t>(problem.problem().n_constraints()));
    std::vector<mmc::BodyProblem> designed;
    const std::vector<mmc::BodyOutcome> found =
        problem.design(prepared.scene().optimizer, {}, designed);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].compliance, run.design.outcomes[0].compliance);
    EXPECT_EQ(found[0].crisp.compliance, run.design.outcomes[0].crisp.compliance);
    EXPECT_EQ(designed[0].design.x(), run.design.problems[0].design.x());
  }
}

TEST(DesignProblems, ContinueInAnotherStage) {
  const PreparedCase prepared = load_case("short_beam", kSmall);
  DesignProblem coarse(prepared, {.body = "beam", .stage = DesignStage::coarse});
  const VectorXd x = coarse.problem().start();
  DesignProblem last = coarse.at(DesignStage::last, x);
  EXPECT_EQ(last.problem().start(), x);
  EXPECT_GT(last.problem().n_constraints(), coarse.problem().n_constraints());
  EXPECT_FALSE(last.problem().has_curvature());
  EXPECT_TRUE(coarse.problem().has_curvature());
  EXPECT_THROW(coarse.at(DesignStage::last, VectorXd::Zero(3)), Error);
}

TEST(DesignProblems, AreRefusedWhereTheCaseHasNone) {
  const PreparedCase beam = load_case("short_beam", kSmall);
  EXPECT_THROW(DesignProblem(beam, {.body = "nothing"}), Error);
  EXPECT_THROW(DesignProblem(beam, {.of_motion = true}), Error);
  const PreparedCase moving = load_case("deploying_beam", Changes{"time.end=0.05"});
  EXPECT_THROW(DesignProblem(moving, {}), Error);
}

TEST(ComputeInto, WritesTheFolderOfTheProgram) {
  const Scratch scratch;
  const ReadyCase ready = ready_case("short_beam", kSmall);
  int iterations = 0;
  std::string said;
  ComputeSettings settings;
  settings.iteration = [&](const mmc::IterationReport&) { ++iterations; };
  settings.say = [&](const std::string& words) { said += words; };
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  // After four iterations the design is not usable.
  EXPECT_EQ(compute_into(ready, scratch / "run", settings), 5);
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  EXPECT_FALSE(said.empty());
  EXPECT_EQ(iterations, 4);
  const test::json run = test::run_json(scratch / "run");
  EXPECT_EQ(run["status"].get<std::string>().substr(0, 4), "done");
  EXPECT_TRUE(std::filesystem::exists(scratch / "run/components.csv"));
  // A complete run is not computed again.
  EXPECT_EQ(compute_into(ready, scratch / "run", settings, true), 5);
  EXPECT_EQ(iterations, 4);
  // An interrupted run has its results so far.
  settings.keep_running = [&] { return iterations < 6; };
  EXPECT_EQ(compute_into(ready, scratch / "stopped", settings), 4);
  EXPECT_EQ(test::run_json(scratch / "stopped")["status"], "interrupted");
}

/// A bar that turns about a pin.
const std::string kBar =
    "title = \"Bar\"\n[time]\nend = 0.1\nstep = 1e-3\n[[rigid_body]]\nname = \"bar\"\n"
    "mass = 1.0\nsize = [0.4, 0.02]\ncenter = [0.2, 0.0]\n[[joint]]\ntype = \"revolute\"\n"
    "name = \"pin\"\na = \"ground\"\npoint_a = [0.0, 0.0]\nb = \"bar\"\n";

TEST(CaseTexts, AreReadLikeFiles) {
  const Changes changes{"title=Rod"};
  const Scene scene = read_scene(io::CaseFile::of_text(kBar, "rod.toml", changes));
  EXPECT_EQ(scene.title, "Rod");
  EXPECT_EQ(scene.name, "rod");
  try {
    read_scene(io::CaseFile::of_text(kBar + "mas = 1\n", "rod.toml"));
    ADD_FAILURE() << "an unknown key is accepted";
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).rfind("rod.toml:16:", 0), 0u) << error.what();
  }
}

TEST(RegisteredDrives, MoveLikeTheirFormulas) {
  static const DriveRow kSwing{
      "swing", "A test.", [](double t) {
        return fem::Motion{0.3 * std::sin(4 * t), 1.2 * std::cos(4 * t), -4.8 * std::sin(4 * t)};
      }};
  register_drive(kSwing);
  EXPECT_THROW(register_drive(kSwing), Error);
  EXPECT_THROW(register_drive({"empty", "", {}}), Error);
  const std::string text = kBar +
                           "[[joint]]\ntype = \"angle_drive\"\nname = \"motor\"\nb = \"bar\"\n"
                           "angle = \"turn\"\n[[drive]]\nname = \"turn\"\n";
  const auto motion = [&](const std::string& source) {
    return compute(ready_case(io::CaseFile::of_text(text + source, "swing.toml"), {}).prepared)
        .motions.motion->table;
  };
  const Series own = motion("from = \"swing\"\n"), formula = motion("formula = \"0.3*sin(4*t)\"\n");
  ASSERT_EQ(own.columns.size(), formula.columns.size());
  for (size_t c = 0; c < own.columns.size(); ++c)
    for (size_t r = 0; r < own.n_rows(); ++r)
      EXPECT_NEAR(own.values[c][r], formula.values[c][r],
                  1e-12 * std::max(1.0, largest_size(formula.values[c])))
          << own.columns[c].name;
}

}  // namespace
}  // namespace flexmorph::cases
