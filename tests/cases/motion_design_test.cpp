// Shows that design problems for the motion itself have correct gradients, that the optimality
// certificate bounds the possible decrease, and that runs with corrections and the commands
// `compare` and `certify` work.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "cases/assembly/scene_motion.h"
#include "io/case_files/case_file.h"
#include "io/tables.h"
#include "optim/mmc/cycles/optimality_certificate.h"
#include "tests/cases/program.h"
#include "tests/cases/run_json.h"
#include "tests/support/differences.h"
#include "tests/support/errors.h"

namespace flexmorph::test {
namespace {

using cases::SceneMotion;

/// Returns the short case of the growing, rotating plate on coarse cells. The motion ends at 0.06
/// s, half of its time, unless `changes` set another end.
cases::Scene short_scene(std::vector<std::string> changes) {
  changes.insert(changes.begin(), "time.end=0.06");
  changes.insert(changes.end(),
                 {"design.cell=0.01", "design.min_thickness=0.01", "esl.every=0.02"});
  return cases::read_scene(io::CaseFile(FLEXMORPH_SHORT_CASE, changes));
}

/// Returns a small static model that the design problem requires but never evaluates, because the
/// design is for a motion only.
mmc::ComplianceEvaluator any_loads() {
  const Grid cell;
  const fem::HeldUnknown held[] = {{0, 0}, {0, 1}, {1, 0}};
  const mmc::LoadCase loads[] = {{"tip", 1, {{3, {0, 1}}}, 0}};
  return {{cell, {1, 1, 0.3, 1}, {}}, held, loads, false};
}

/// The design problem of a scene for its motion, at the start layouts of the scene.
class DesignedForMotion {
 public:
  explicit DesignedForMotion(cases::Scene scene)
      : prepared_(std::move(scene)),
        problems_(prepared_.design_problems()),
        parts_(parts_of(problems_, loads_)),
        formulations_(formulations_of(problems_)),
        motion_(prepared_, {.cell = 0, .step = 2e-3, .checkpoints = 0}, {}),
        state_(mmc::motion_state_of(parts_, motion_)),
        whole_(parts_, mmc::designs_of(parts_), formulations_, state_) {}

  optim::Problem& problem() { return whole_.problem(); }
  const mmc::CombinedProblem& whole() const { return whole_; }

 private:
  static std::vector<mmc::Subproblem> parts_of(std::vector<mmc::BodyProblem>& problems,
                                               mmc::ComplianceEvaluator& loads) {
    std::vector<mmc::Subproblem> out;
    for (mmc::BodyProblem& problem : problems) out.emplace_back(mmc::LoadedBody{problem, loads});
    return out;
  }
  static std::vector<mmc::Formulation> formulations_of(
      const std::vector<mmc::BodyProblem>& problems) {
    std::vector<mmc::Formulation> out;
    for (const mmc::BodyProblem& problem : problems) out.push_back(mmc::eroded(problem));
    return out;
  }

  mmc::ComplianceEvaluator loads_ = any_loads();
  cases::PreparedCase prepared_;
  std::vector<mmc::BodyProblem> problems_;
  std::vector<mmc::Subproblem> parts_;
  std::vector<mmc::Formulation> formulations_;
  SceneMotion motion_;
  mmc::MotionState state_;
  mmc::CombinedProblem whole_;
};

/// Compares the derivative of the objective and of the given constraints in one direction with
/// difference quotients of fourth order.
void expect_gradient(optim::Problem& problem, const std::vector<int>& constraints) {
  const VectorXd x = problem.start();
  const optim::ProblemValues r = problem.evaluate(x);
  EXPECT_GT(r.df.norm(), 0);
  VectorXd direction(x.size());
  for (Eigen::Index k = 0; k < x.size(); ++k) direction[k] = std::sin(3.7 * static_cast<double>(k));
  direction *= 1 / direction.norm();
  const auto n = static_cast<Eigen::Index>(constraints.size());
  const auto values = [&](double by) {
    const optim::ProblemValues at = problem.evaluate(x + by * direction);
    VectorXd out(1 + n);
    out[0] = at.f;
    for (Eigen::Index i = 0; i < n; ++i) out[1 + i] = at.g[constraints[static_cast<size_t>(i)]];
    return out;
  };
  const VectorXd slopes = testing::first_difference(values, 1e-4);
  for (Eigen::Index i = 0; i <= n; ++i) {
    const VectorXd df = i == 0 ? r.df : VectorXd(r.dg.row(constraints[static_cast<size_t>(i - 1)]));
    EXPECT_NEAR(df.dot(direction), slopes[i], 2e-6 * std::abs(slopes[i]) + 1e-8 * df.norm()) << i;
  }
}

class EveryRow : public ::testing::TestWithParam<const char*> {};

// The derivatives pass through components, TDF, Heaviside function, ersatz material, void of
// motions and the motion itself, with respect to the variables of the optimizer. The motion for the
// strain energy is longer and includes a change of the mesh at 0.1 s.
TEST_P(EveryRow, HasTheGradientThatDifferencesSay) {
  const std::string minimized = GetParam();
  DesignedForMotion design(
      short_scene({"design.minimize=" + minimized, "cycle.correct=direct",
                   minimized == "strain_energy" ? "time.end=0.12" : "time.end=0.06"}));
  expect_gradient(design.problem(), {});
}

INSTANTIATE_TEST_SUITE_P(MotionDesign, EveryRow,
                         ::testing::Values("strain_energy", "peak_strain_energy", "deflection",
                                           "joint_force"),
                         [](const auto& test) { return std::string(test.param); });

// The objective of a weighted sum is the weighted sum of the separately computed objectives; its
// gradient is the weighted sum of their gradients.
TEST(MotionSum, IsWeighted) {
  struct Number {
    double f;
    VectorXd df;
  };
  const auto number = [&](const std::string& minimized, const std::string& added) {
    Words changes = {"design.minimize=" + minimized, "cycle.correct=direct"};
    if (!added.empty()) changes.push_back("design.objective=" + added);
    DesignedForMotion design(short_scene(changes));
    const optim::ProblemValues r = design.problem().evaluate(design.problem().start());
    return Number{std::exp(r.f), std::exp(r.f) * r.df};
  };
  const Number energy = number("strain_energy", ""), deflection = number("deflection", ""),
               force = number("joint_force", ""),
               sum = number("strain_energy",
                            "[{response=\"deflection\", weight=3.0}, "
                            "{response=\"joint_force\", weight=0.001}]");
  const double f = energy.f + 3 * deflection.f + 1e-3 * force.f;
  EXPECT_NEAR(sum.f, f, 1e-12 * f);
  const VectorXd df = energy.df + 3 * deflection.df + 1e-3 * force.df;
  EXPECT_LT((sum.df - df).norm(), 1e-9 * df.norm());  // The adjoint systems are solved to 2e-13.
}

// The callback is asked at every step of the motion and of its adjoint.
TEST(SceneMotions, StopWithinAStepWhenTheyAreCancelled) {
  const cases::PreparedCase prepared(
      short_scene({"design.minimize=strain_energy", "cycle.correct=direct"}));
  const std::vector<mmc::BodyProblem>& problems = prepared.design_problems();
  const mmc::Goal* goal = &problems.front().motion_goal;
  const std::vector<mmc::MotionRow> rows = mmc::motion_objectives({&goal, 1});
  const VectorXd fractions = VectorXd::Constant(problems.front().grid.n_cells(), 0.5);
  const std::vector<mmc::CellScaleFactors> factors = {mmc::Ersatz::dynamic(fractions, 1e-3, 1e-3)};
  int asked = 0, last = std::numeric_limits<int>::max();
  SceneMotion motion(prepared, {.cell = 0, .step = 2e-3, .checkpoints = 0},
                     [&] { return ++asked < last; });
  motion.evaluate(rows, factors);
  const int all = asked, steps = 30;
  EXPECT_GE(all, 2 * steps);
  for (const int end : {1, steps / 2, all - 2}) {
    asked = 0;
    last = end;
    EXPECT_THROW(motion.evaluate(rows, factors), cases::StoppedMotion);
    EXPECT_EQ(asked, end);
  }
  asked = 0;
  last = steps / 2;
  EXPECT_THROW(motion.crisp(rows, std::vector{fractions}), cases::StoppedMotion);
  EXPECT_EQ(asked, last);
}

// A constraint of one body depends on the designs of all bodies; here a spring couples the ends of
// two plates.
TEST(MotionLimits, OfOneBodyHaveGradientsByAll) {
  const std::string limit =
      "constraint=[{response=\"volume\", at_most=0.5}, "
      "{response=\"joint_force\", at_most=1.0}]";
  const Words changes = {
      "cycle.correct=direct",
      "design.0.coupling=none",
      "design.1.coupling=none",
      "design.0." + limit,
      "design.1." + limit,
      "spring=[{a=\"heavy\", point_a=[0.5, 0.0], b=\"light\", point_b=[0.5, 0.0], "
      "free_length=2.0, stiffness=3000.0}]",
      "design.0.minimize=strain_energy",
      "design.1.minimize=strain_energy",
      "design.0.max_volume=",
      "design.1.max_volume="};
  const cases::Scene scene = cases::read_scene(io::CaseFile(FLEXMORPH_TWO_PLATES, changes));
  DesignedForMotion design(scene);
  const int heavy = design.whole().row_of(0, 1), light = design.whole().row_of(1, 1);
  expect_gradient(design.problem(), {heavy, light});
  const optim::ProblemValues r = design.problem().evaluate(design.problem().start());
  for (const int row : {heavy, light})
    for (const size_t body : {0, 1})
      EXPECT_GT(design.whole().part_of(r.dg.row(row), body).norm(), 1e-3 * r.dg.row(row).norm());
}

// Two variables and one active constraint x + y <= 0: within a radius of 0.1, log J decreases most
// along (1, -1), by 0.1 (2 - 1). The multiplier 1.5 gives exactly this bound; any other multiplier
// gives a larger one.
TEST(OptimalityCertificate, BoundsWhatIsLeft) {
  optim::ProblemValues r;
  r.df = Vec2(-2, -1);
  r.g = VectorXd::Zero(1);
  r.dg = MatrixXd::Ones(1, 2);
  const VectorXd x = Vec2::Zero(), lower = Vec2::Constant(-1), upper = Vec2::Constant(1);
  const auto left = [&](double lambda) {
    return mmc::left_within(r, x, lower, upper, VectorXd::Constant(1, lambda), 0.1);
  };
  EXPECT_NEAR(left(1.5), 0.1, 1e-14);
  for (const double lambda : {0.0, 1.0, 1.2, 1.9, 3.0}) EXPECT_GE(left(lambda), 0.1 - 1e-14);
  // A variable at its upper bound cannot move further.
  EXPECT_NEAR(mmc::left_within(r, x, lower, Vec2(0, 1), VectorXd::Constant(1, 1.0), 0.1), 0, 1e-14);
}

/// Designs the short plate for its loads and then corrects it for its motion. @returns run.json
json run_corrected(const Scratch& scratch, const std::string& folder, const std::string& way,
                   Words more = {}) {
  Words changes = {"cycle.correct=" + way, "cycle.corrections=2",       "cycle.step=2e-3",
                   "design.cell=0.01",     "design.min_thickness=0.01", "esl.every=0.02",
                   "output.vtk=false",     "certificate.step=2e-3"};
  changes.insert(changes.end(), more.begin(), more.end());
  const Ended ended = run(scratch, FLEXMORPH_SHORT_CASE, folder, changes);
  EXPECT_TRUE(is_done(ended, folder));
  return run_json(folder);
}

class EveryCorrection : public ::testing::TestWithParam<const char*> {};

TEST_P(EveryCorrection, LowersWhatTheMotionSays) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const json run = run_corrected(scratch, folder, GetParam(), {"cycle.corrections=3"});
  const auto& cycles = run["corrected_cycles"];
  ASSERT_GE(cycles.size(), 2u);
  double least = cycles[0]["objective"];
  for (const auto& cycle : cycles)
    if (cycle["accepted"].get<bool>()) least = std::min(least, cycle["objective"].get<double>());
  // Six iterations leave the design for loads far from the optimum of the motion: three corrections
  // reduce the objective to 0.16 and 0.22 of its first value (first_order and direct). The bound of
  // the test is 0.5.
  EXPECT_LT(least, 0.5 * cycles[0]["objective"].get<double>());
  EXPECT_GT(run["certificate"]["kkt"].get<double>(), 0);
  EXPECT_GT(run["certificate"]["left"].get<double>(), 0);
  // The certificate of the crisp design is reported next to that of the smoothed design.
  for (const char* name : {"crisp_value", "crisp_kkt", "crisp_left"})
    EXPECT_GT(run["certificate"][name].get<double>(), 0) << name;
  EXPECT_NE(run["certificate"]["crisp_kkt"], run["certificate"]["kkt"]);
  const io::CsvTable table = io::read_csv(folder + "/cycles.csv");
  EXPECT_EQ(table.numbers("objective").size(), cycles.size());
  const io::CsvTable arrows = io::read_csv(folder + "/certificate.csv");
  EXPECT_GE(arrows.numbers("by_x").size(), 1u);
  // The report shows the certificate and, if corrected designs were kept, the designs before them.
  const std::string report = contents_of(folder + "/report.html");
  const auto shows = [&](const char* name) {
    const std::string picture = contents_of(folder + "/" + name);
    const size_t begin = picture.find("<svg");
    EXPECT_NE(begin, std::string::npos) << name;
    return begin != std::string::npos && report.find(picture.substr(begin)) != std::string::npos;
  };
  EXPECT_TRUE(shows("certificate.svg"));
  EXPECT_EQ(shows("design_esl.svg"), run["corrected"]["kept"].get<bool>());
}

INSTANTIATE_TEST_SUITE_P(MotionDesign, EveryCorrection, ::testing::Values("first_order", "direct"),
                         [](const auto& test) { return std::string(test.param); });

// With loads = "worst" the objective of the motion is the largest strain energy.
TEST(MotionDesign, OfTheWorstLoadLowersTheLargestEnergy) {
  const Scratch scratch;
  const json run = run_corrected(scratch, scratch / "out", "first_order", {"design.loads=worst"});
  EXPECT_TRUE(testing::mentions_all(run["certificate"]["objective"], {"largest", "strain energy"}));
  const auto& cycles = run["corrected_cycles"];
  double least = cycles[0]["objective"];
  for (const auto& cycle : cycles)
    if (cycle["accepted"].get<bool>()) least = std::min(least, cycle["objective"].get<double>());
  EXPECT_LT(least, 0.5 * cycles[0]["objective"].get<double>());  // Measured ratio: 0.087.
}

// `certify` on a finished run reproduces the certificate that the run wrote at its end.
TEST(Certify, SaysOfAFinishedRunWhatTheRunWouldHaveSaid) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const json first = run_corrected(scratch, folder, "first_order", {"cycle.corrections=0"});
  const double kkt = first["certificate"]["kkt"], value = first["certificate"]["value"];
  const Ended ended = flexmorph(scratch, {"certify", folder});
  EXPECT_EQ(ended.code, 0) << ended.err;
  const json again = run_json(folder);
  EXPECT_NEAR(again["certificate"]["value"].get<double>(), value, 1e-6 * value);
  EXPECT_NEAR(again["certificate"]["kkt"].get<double>(), kkt, 1e-3 * kkt);
  EXPECT_EQ(again["corrected_cycles"], first["corrected_cycles"]);
}

TEST(Certify, RefusesWhatIsNoFinishedRun) {
  const Scratch scratch;
  const Ended ended = flexmorph(scratch, {"certify", scratch / "nowhere"});
  EXPECT_EQ(ended.code, 2);
  EXPECT_TRUE(testing::mentions_all(
      ended.err, {"'" + (scratch / "nowhere") + "'", "finished run", "case.toml"}));
}

TEST(CompareCycles, HasARowForEveryWay) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  Words words = {"compare", FLEXMORPH_SHORT_CASE, "--cycles", "esl,corrected,direct", "-o", folder,
                 "--quiet"};
  for (const char* change :
       {"cycle.corrections=1", "cycle.step=4e-3", "design.cell=0.01", "design.min_thickness=0.01",
        "esl.every=0.02", "certificate.step=4e-3", "time.end=0.04", "output.vtk=false"})
    words.insert(words.end(), {"--set", change});
  const Ended ended = flexmorph(scratch, words);
  EXPECT_EQ(ended.code, 0) << ended.err;
  const io::CsvTable table = io::read_csv(folder + "/compare.csv");
  ASSERT_EQ(table.texts("cycles"), Words({"esl", "corrected", "direct"}));
  for (size_t k = 0; k < 3; ++k) {
    const json certificate = run_json(folder + "/" + table.texts("cycles")[k])["certificate"];
    const auto near = [&](const char* column, const char* key) {
      const double value = certificate[key].get<double>();
      // The table has three digits.
      EXPECT_NEAR(table.numbers(column)[k], value, 5e-3 * value) << column;
    };
    near("J", "value");
    near("crisp J", "crisp_value");
    near("KKT residual", "kkt");
  }
  // All cycles begin with the design for loads; a correction replaces it only by a better design.
  const auto least = table.numbers("least J met");
  for (const size_t corrected : {1, 2}) EXPECT_LE(least[corrected], least[0]);
  EXPECT_NE(contents_of(folder + "/compare.svg").find("<svg"), std::string::npos);
}

}  // namespace
}  // namespace flexmorph::test
