// Shows that defects found by `flexmorph stability` stay repaired, and what its suites rely on:
// condition numbers, tables of an unfinished check, starts of short motions, changes that a step
// does not resolve.

#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <thread>

#include "cases/check/ready.h"
#include "cases/stability/stability.h"
#include "io/tables.h"
#include "tests/cases/program.h"
#include "tests/cases/run_json.h"
#include "tests/support/errors.h"

namespace flexmorph::cases {
namespace {

using nlohmann::json;
using test::Ended;
using test::Words;

Ended stability_run(const Scratch& scratch, const std::string& name, const Words& changes,
                    const Words& more = {}) {
  Words words = {"run", name, "-o", scratch / "run", "--quiet"};
  words.insert(words.end(), more.begin(), more.end());
  for (const std::string& change : changes) words.insert(words.end(), {"--set", change});
  return test::flexmorph(scratch, words);
}

json run_of(const Scratch& scratch) { return test::run_json(scratch / "run"); }

const Words kLean = {"expect=", "accuracy=", "output.vtk=false", "output.plots=false"};

Words lean(const Words& more) {
  Words out = kLean;
  out.insert(out.end(), more.begin(), more.end());
  return out;
}

// Condition numbers are computed only if --condition is given.
TEST(ConditionOfARun, IsThereOnDemand) {
  const Scratch scratch;
  const Words short_motion = lean({"time.end=2e-3", "body.elements=[2, 2]"});
  ASSERT_EQ(stability_run(scratch, "plate_pendulum", short_motion).code, 0);
  EXPECT_FALSE(run_of(scratch)["motion"].contains("condition"));
  ASSERT_EQ(stability_run(scratch, "plate_pendulum", short_motion, {"--condition"}).code, 0);
  EXPECT_GE(run_of(scratch)["motion"]["condition"].get<double>(), 1);
}

/// Returns the largest condition number of the motion, the static path and the designs.
double condition_of(const Scratch& scratch, const std::string& name, const Words& changes,
                    int code = 0) {
  const Ended ended = stability_run(scratch, name, lean(changes), {"--condition"});
  EXPECT_EQ(ended.code, code) << ended.err;
  const json out = run_of(scratch);
  double worst = 0;
  for (const char* part : {"motion", "static"})
    if (out.contains(part)) worst = std::max(worst, out[part].value("condition", 0.0));
  for (const json& design : out["results"]) worst = std::max(worst, design.value("condition", 0.0));
  return worst;
}

// A void of relative stiffness alpha² between regions of material costs 2 log10(1/alpha) digits:
// alpha = 1e-4 instead of 1e-2 costs 4 digits. The unit of Young's modulus costs none.
TEST(ConditionOfARun, OfDesignsGrowsAsTheVoidThins) {
  const Scratch scratch;
  const std::string start =
      scratch.write("start.csv", "X0,Y0,half_length,angle,c1,c2,c3\n0.3,0.5,0.2,0,0.2,0.2,0.2\n");
  const Words analysed = {"optimizer.max_iterations=0", "design.cell=0.05",
                          "design.start='" + start + "'"};
  const auto with = [&](const std::string& change) {
    Words changes = analysed;
    changes.push_back(change);
    // The single component does not connect loads and support.
    return condition_of(scratch, "short_beam", changes, test::kTooFew);
  };
  const double own = with("design.alpha=1e-2"), thin = with("design.alpha=1e-4");
  EXPECT_GT(own, 1e3);
  EXPECT_NEAR(std::log10(thin / own), 4, 0.5);
  const double stiff = with("domain.youngs_modulus=2e11"), soft = with("domain.youngs_modulus=1");
  EXPECT_NEAR(stiff, soft, 1e-3 * soft);
}

// The stiffness matrix of a static cantilever: κ grows with the fourth power of the number of
// elements where bending dominates. Twice as many elements give a factor of about 16, here bounded
// by 4 and 32.
TEST(ConditionOfARun, OfPathsGrowsWithTheMesh) {
  const Scratch scratch;
  const auto with = [&](const char* elements) {
    return condition_of(scratch, "cantilever_roll_up",
                        {"static.steps=1", "static.to=1e-3", elements});
  };
  const double coarse = with("body.elements=[4, 1]"), fine = with("body.elements=[8, 1]");
  EXPECT_GT(coarse, 1);
  EXPECT_GT(fine, 4 * coarse);
  EXPECT_LT(fine, 32 * coarse);
}

// A check that is killed while it runs leaves complete tables.
TEST(Tables, AreThereBeforeTheEnd) {
  const Scratch scratch;
  const std::string folder = scratch / "out", table = folder + "/stability.csv";
  testing::ChildProgram check =
      test::start(scratch, {"stability", "plate_pendulum", "-o", folder, "--suites",
                            "stiffness,step,rho_inf", "--set", "body.elements=[2, 2]"});
  ASSERT_TRUE(testing::eventually(check, [&] { return std::filesystem::exists(table); }));
  check.send(SIGKILL);
  check.end();
  const io::CsvTable rows = io::read_csv(table);  // read_csv() refuses incomplete lines.
  EXPECT_GE(rows.n_rows(), 10u);
  EXPECT_EQ(rows.texts("suite")[0], "base");
}

// A former version computed the rate of the initial shape by a difference over 2e-4 s. This reaches
// beyond the end of the present motion, where its drives are not defined ("material lines 0 and 1
// cross").
TEST(Starts, OfMotionsShorterThanADifference) {
  const Scratch scratch;
  const Ended ended =
      stability_run(scratch, "motion_platform",
                    lean({"design=", "optimizer=", "esl=", "verify=", "cycle=", "time.step=1e-6",
                          "time.end=1e-5"}));
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_LT(run_of(scratch)["motion"]["velocity_drift"].get<double>(), 1e-6);
}

// The temperature jumps at the start. In a former version the first guess of a step turned the beam
// inside out, and Newton's method converged to that state. The ends of the beam must oscillate by α
// ΔT L/2 (1 - cos ω t) = 0.01 m (1 - cos ω t).
TEST(Starts, AtTemperaturesThatJump) {
  const Scratch scratch;
  const Ended ended =
      stability_run(scratch, "free_beam_heated", lean({"time.end=0.04", "body.heat.profile=step"}));
  ASSERT_EQ(ended.code, 0) << ended.err;
  // The energy that a jump of the temperature brings in is not a power. Therefore the energy
  // balance does not contain it, and the warning states this reason.
  EXPECT_TRUE(testing::mentions_all(
      ended.err, {"energy balance", "temperature", "'beam'", "t = 0 s", "body.heat.profile"}));
  EXPECT_GT(run_of(scratch)["motion"]["smallest_area_ratio"].get<double>(), 0.9);
  const std::vector<double> end =
      io::read_csv(scratch / "run" + "/motion.csv").numbers("beam.end_ux");
  double mean = 0;
  for (const double u : end) mean += u / static_cast<double>(end.size());
  EXPECT_NEAR(mean, 0.01, 1e-3);
  EXPECT_LT(*std::max_element(end.begin(), end.end()), 0.0205);
  EXPECT_GT(*std::min_element(end.begin(), end.end()), -5e-4);
}

// The motion of a drive with a formula does not depend on the addresses of libraries in memory,
// which differ from process to process: six processes must write identical tables.
TEST(Starts, AreTheSameBitForBit) {
  const Scratch scratch;
  std::string first;
  for (int k = 0; k < 6; ++k) {
    const Ended ended = stability_run(
        scratch, "four_bar",
        lean({"design=", "optimizer=", "esl=", "cycle=", "verify=", "time.end=2e-3"}));
    ASSERT_EQ(ended.code, 0) << ended.err;
    const std::string table = contents_of(scratch / "run" + "/motion.csv");
    if (k == 0) first = table;
    EXPECT_EQ(table, first);
  }
}

std::string warnings_of(const Scratch& scratch, const std::string& name, const Words& changes,
                        int code = 0) {
  const std::string folder = scratch / "run";
  Words words = {"run", name, "-o", folder, "--quiet", "--set", "expect="};
  for (const std::string& change : changes) words.insert(words.end(), {"--set", change});
  const Ended ended = test::flexmorph(scratch, words);
  EXPECT_EQ(ended.code, code) << ended.err;
  const std::string text = contents_of(folder + "/run.json");
  const size_t begin = text.find("\"warnings\"");
  return text.substr(begin, text.find("\"results\"") - begin);
}

// Runs that succeed but are unreliable give a warning; energy errors of round-off do not.
TEST(Warnings, OfEnergyThatIsMissed) {
  const Scratch scratch;
  const Words lean = {"time.end=0.04", "expect=", "accuracy=", "output.vtk=false",
                      "output.plots=false"};
  Words hit = lean, rest = lean;
  // The temperature rises within one step, which is two thirds of an axial period.
  hit.emplace_back("body.heat.duration=1e-3");
  EXPECT_TRUE(contains(warnings_of(scratch, "free_beam_heated", hit), "energy balance"));
  rest.emplace_back("body.heat.rise=0");
  EXPECT_FALSE(contains(warnings_of(scratch, "free_beam_heated", rest), "energy balance"));
}

TEST(Warnings, OfVolumesThatAreNotReached) {
  const Scratch scratch;
  const Words lean = {"optimizer.max_iterations=5", "output.vtk=false", "output.plots=false",
                      "design.cell=0.05", "design.min_feature=0"};
  Words small = lean;
  small.emplace_back("design.max_volume=0.01");
  EXPECT_TRUE(testing::mentions_all(warnings_of(scratch, "short_beam", small, test::kTooFew),
                                    {"volume", "'beam'", "allowed value 0.01"}));
  small.back() = "design.max_volume=0.9";
  EXPECT_FALSE(contains(warnings_of(scratch, "short_beam", small, test::kTooFew), "allowed value"));
}

// The drive keeps the crank at rest, therefore the velocity given by the case contradicts it.
TEST(Starts, AtSpeedsThatTheDriveDoesNotAllow) {
  const Scratch scratch;
  const Ended ended = test::flexmorph(
      scratch, {"check", "four_bar", "--set", "rigid_body.crank.velocity=[100, -70]"});
  EXPECT_EQ(ended.code, 2);
  EXPECT_TRUE(testing::mentions_all(
      ended.err,
      {"four_bar.toml:", "rigid_body.crank.velocity = [100, -70]", "'crank_on_ground'"}));
}

// Such components would silently be moved into the domain and give another design than that of the
// file.
TEST(Starts, OutsideOfTheDomainAreRefused) {
  const Scratch scratch;
  const std::string header = "X0,Y0,half_length,angle,c1,c2,c3\n";
  const std::string start =
      scratch.write("start.csv", header + "1,0.5,1,0,0.1,0.1,0.1\n1,-0.1,1,0,0.1,0.1,0.1\n");
  const Ended ended =
      test::flexmorph(scratch, {"check", "short_beam", "--set", "design.start='" + start + "'"});
  EXPECT_EQ(ended.code, 2);
  EXPECT_TRUE(testing::mentions_all(ended.err, {"component 2", "[0, 2] x [0, 1] [m]"},
                                    "flexmorph: --set design.start='" + start + "': "));
}

}  // namespace
}  // namespace flexmorph::cases
