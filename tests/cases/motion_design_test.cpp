// Designs for the motion itself: the gradient of the design problem, the certificate's bound, runs
// that correct designs, and the commands that compare and certify them.

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "cases/build/scene_motion.h"
#include "io/case_file.h"
#include "io/tables.h"
#include "optim/mmc/motion_certificate.h"
#include "tests/cases/program.h"
#include "tests/support/differences.h"

namespace flexmorph::test {
namespace {

using cases::SceneMotion;

/// The growing, turning plate in short on coarse cells.
cases::Scene short_scene(std::vector<std::string> changes) {
  changes.insert(changes.end(),
                 {"design.cell=0.01", "design.min_thickness=0.01", "esl.every=0.02"});
  return cases::read_scene(io::CaseFile(FLEXMORPH_SHORT_CASE, changes));
}

/// Nobody asks for the statics of a design for its motion.
class NoLoads final : public mmc::LoadResponse {
 public:
  void evaluate(const VectorXd&, const VectorXd&, Value&) override { throw Error::input("none"); }
  void evaluate_each(const VectorXd&, const VectorXd&, Each&) override {
    throw Error::input("none");
  }
  VectorXd individual(const VectorXd&, const VectorXd&) override { return {}; }
  VectorXd displacement(const VectorXd&, const VectorXd&, int) override { return {}; }
  int n_loads() const override { return 0; }
  int n_right_hand_sides() const override { return 0; }
  int factorizations() const override { return 0; }
  double condition() const override { return 1; }
  Seconds seconds() const override { return {}; }
};

class EveryRow : public ::testing::TestWithParam<const char*> {};

// Through components, TDF, Heaviside, ersatz material, void of motions, and the motion itself: by
// the variables that an optimizer sees, against differences of fourth order.
TEST_P(EveryRow, HasTheGradientThatDifferencesSay) {
  const cases::Scene scene =
      short_scene({std::string("design.minimize=") + GetParam(), "cycle.correct=direct"});
  std::vector<mmc::BodyProblem> problems = cases::build_problems(scene);
  NoLoads loads;
  const mmc::LoadedBody body{problems[0], loads};
  mmc::Part part(body);
  part.tdf = &problems[0].stages.back();
  std::vector<mmc::Part> parts;
  parts.push_back(std::move(part));
  SceneMotion motion(scene, {.cell = 0, .step = 2e-3, .checkpoints = 0}, {});
  mmc::MotionState state = mmc::motion_state_of(parts, motion);
  mmc::Whole whole(parts, &state);
  const VectorXd x = whole.problem().start();
  const optim::Response r = whole.problem().evaluate(x);
  EXPECT_GT(r.df.norm(), 0);
  VectorXd direction(x.size());
  for (Eigen::Index k = 0; k < x.size(); ++k) direction[k] = std::sin(3.7 * static_cast<double>(k));
  direction *= 1 / direction.norm();
  const double slope = testing::first_difference(
      [&](double by) { return whole.problem().evaluate(x + by * direction).f; }, 1e-4);
  EXPECT_NEAR(r.df.dot(direction), slope, 2e-6 * std::abs(slope) + 1e-8 * r.df.norm());
}

INSTANTIATE_TEST_SUITE_P(MotionDesign, EveryRow,
                         ::testing::Values("strain_energy", "deflection", "joint_force"),
                         [](const auto& test) { return std::string(test.param); });

// Two variables, one limit x + y <= 0 that is met: within 0.1, log J falls most along (1, -1), by
// 0.1 (2 - 1); the multiplier that says so is 1.5, and any other one allows more.
TEST(MotionCertificate, BoundsWhatIsLeft) {
  optim::Response r;
  r.df = Vec2(-2, -1);
  r.g = VectorXd::Zero(1);
  r.dg = MatrixXd::Ones(1, 2);
  const VectorXd x = Vec2::Zero(), lower = Vec2::Constant(-1), upper = Vec2::Constant(1);
  const auto left = [&](double lambda) {
    return mmc::left_within(r, x, lower, upper, VectorXd::Constant(1, lambda), 0.1);
  };
  EXPECT_NEAR(left(1.5), 0.1, 1e-14);
  for (const double lambda : {0.0, 1.0, 1.2, 1.9, 3.0}) EXPECT_GE(left(lambda), 0.1 - 1e-14);
  // At its bound a variable goes no further.
  EXPECT_NEAR(mmc::left_within(r, x, lower, Vec2(0, 1), VectorXd::Constant(1, 1.0), 0.1), 0, 1e-14);
}

/// The short plate designed for its loads, then for its motion.
nlohmann::json run_corrected(const Scratch& scratch, const std::string& folder,
                             const std::string& way, Words more = {}) {
  Words changes = {"cycle.correct=" + way, "cycle.corrections=3",       "cycle.step=2e-3",
                   "design.cell=0.01",     "design.min_thickness=0.01", "esl.every=0.02",
                   "output.vtk=false",     "certificate.step=2e-3"};
  changes.insert(changes.end(), more.begin(), more.end());
  const Ended ended = run(scratch, FLEXMORPH_SHORT_CASE, folder, changes);
  EXPECT_TRUE(ended.code == 0 || ended.code == kTooFew) << ended.err;
  return nlohmann::json::parse(contents_of(folder + "/run.json"));
}

class EveryCorrection : public ::testing::TestWithParam<const char*> {};

TEST_P(EveryCorrection, LowersWhatTheMotionSays) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const nlohmann::json run = run_corrected(scratch, folder, GetParam());
  const auto& cycles = run["corrected_cycles"];
  ASSERT_GE(cycles.size(), 2u);
  double least = cycles[0]["objective"];
  for (const auto& cycle : cycles)
    if (cycle["accepted"].get<bool>()) least = std::min(least, cycle["objective"].get<double>());
  EXPECT_LT(least, 0.98 * cycles[0]["objective"].get<double>());
  EXPECT_GT(run["certificate"]["kkt"].get<double>(), 0);
  EXPECT_GT(run["certificate"]["left"].get<double>(), 0);
  const io::CsvTable table = io::read_csv(folder + "/cycles.csv");
  EXPECT_EQ(table.numbers("objective").size(), cycles.size());
  const io::CsvTable arrows = io::read_csv(folder + "/certificate.csv");
  EXPECT_GE(arrows.numbers("by_x").size(), 1u);
  EXPECT_NE(contents_of(folder + "/certificate.svg").find("<svg"), std::string::npos);
  EXPECT_NE(contents_of(folder + "/design_esl.svg").find("<svg"), std::string::npos);
  const std::string report = contents_of(folder + "/report.html");
  EXPECT_NE(report.find("Cycles of the motion itself"), std::string::npos);
  EXPECT_NE(report.find("Certificate of the motion"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(MotionDesign, EveryCorrection, ::testing::Values("first_order", "direct"),
                         [](const auto& test) { return std::string(test.param); });

// A finished run is certified later as at its end.
TEST(Certify, SaysOfAFinishedRunWhatTheRunWouldHaveSaid) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const nlohmann::json first =
      run_corrected(scratch, folder, "first_order", {"cycle.corrections=0"});
  const double kkt = first["certificate"]["kkt"], value = first["certificate"]["value"];
  const Ended ended = flexmorph(scratch, {"certify", folder});
  EXPECT_EQ(ended.code, 0) << ended.err;
  const nlohmann::json again = nlohmann::json::parse(contents_of(folder + "/run.json"));
  EXPECT_NEAR(again["certificate"]["value"].get<double>(), value, 1e-6 * value);
  EXPECT_NEAR(again["certificate"]["kkt"].get<double>(), kkt, 1e-3 * kkt);
  EXPECT_EQ(again["corrected_cycles"], first["corrected_cycles"]);
}

TEST(Certify, RefusesWhatIsNoFinishedRun) {
  const Scratch scratch;
  const Ended ended = flexmorph(scratch, {"certify", scratch / "nowhere"});
  EXPECT_EQ(ended.code, 2);
  EXPECT_NE(ended.err.find("is no finished run"), std::string::npos) << ended.err;
}

TEST(CompareCycles, HasARowForEveryWay) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const Ended ended = flexmorph(
      scratch, {"compare", FLEXMORPH_SHORT_CASE, "--cycles", "esl,corrected,direct", "-o", folder,
                "--quiet", "--set", "cycle.corrections=1", "--set", "cycle.step=4e-3", "--set",
                "design.cell=0.01", "--set", "design.min_thickness=0.01", "--set", "esl.every=0.02",
                "--set", "certificate.step=4e-3"});
  EXPECT_EQ(ended.code, 0) << ended.err;
  const std::string table = contents_of(folder + "/compare.csv");
  for (const char* way : {"\nesl,", "\ncorrected,", "\ndirect,"})
    EXPECT_NE(table.find(way), std::string::npos) << table;
  EXPECT_NE(contents_of(folder + "/compare.svg").find("<svg"), std::string::npos);
}

}  // namespace
}  // namespace flexmorph::test
