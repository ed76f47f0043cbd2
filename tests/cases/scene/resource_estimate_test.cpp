// Shows that resource estimates agree with measured runs, and that a run is refused if it exceeds
// the resources of the machine.
#include "cases/assembly/resource_estimate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "cases/check/check_cost.h"
#include "tests/cases/scenes.h"
#include "tests/io/scratch.h"
#include "tests/support/errors.h"

namespace flexmorph::cases {
namespace {

constexpr double kMega = 1e6, kPlenty = 1e18;

std::string complaint(const Scene& scene, const Machine& machine) {
  try {
    require_disk(scene, machine);
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), Error::Kind::input);
    return e.what();
  }
  return "";
}

struct Measured {
  const char* name;
  Changes changes;
  double memory, disk;  ///< Memory in run.json and size of the run folder [MB].
};

// Measured with one thread on 2 cores with AVX-512, 28 November 2026.
TEST(ResourceEstimate, IsThatOfMeasuredRuns) {
  const std::vector<Measured> all = {
      {"cantilever_roll_up", {}, 59.9, 0.72},
      {"square_plate_twist", {}, 65.0, 1.03},
      {"plate_pendulum", {}, 77.1, 4.08},
      {"plate_pendulum", {"body.elements=[40,40]", "time.end=0.004"}, 317, 6.55},
      {"plate_pendulum", {"body.elements=[80,80]", "time.end=0.002"}, 1115, 25.5},
      {"deploying_plate", {"body.flow.mesh=split"}, 67.7, 2.68},
      {"elastic_sleeve", {}, 59.0, 1.01},
      {"andrews", {}, 58.3, 2.54},
      {"spin_up", {}, 58.0, 14.2},
      {"slider_crank_heated", {}, 57.7, 2.62},
      {"satellite_booms", {}, 62.3, 2.34},
      {"heated_boom", {}, 593, 81.0},
      {"slider_crank_designed", {}, 437, 119},
      {"telescopic_crane", {}, 474, 81.6},
      {"motion_platform", {}, 617, 167},
      {"short_beam", {}, 89.6, 6.5},
      {"short_beam", {"design.cell=0.00625", "optimizer.max_iterations=10"}, 333, 17.7},
      {"bridge", {}, 123, 27.7},
      {"mbb", {}, 101, 13.0},
      {"l_bracket", {}, 99, 13.3},
  };
  for (const Measured& each : all) {
    const ResourceEstimate resource_estimate = estimate_resources(read(each.name, each.changes));
    const auto near = [&](double found, double measured, double factor, const char* what) {
      EXPECT_LT(found, factor * measured) << each.name << ": " << what;
      EXPECT_GT(found, measured / factor) << each.name << ": " << what;
    };
    near(resource_estimate.memory_bytes() / kMega, each.memory, 1.5, "memory");
    near(resource_estimate.disk_bytes() / kMega, each.disk, 3, "disk");
  }
}

double seconds_of(const std::string& name, const Changes& changes) {
  const Scene scene = read(name, changes);
  std::optional<Mechanism> built;
  if (!scene.domain) built = build_mechanism(scene);
  return expected_seconds(scene, built ? &*built : nullptr).most;
}

// Expected times grow with the work, on every processor: in proportion to steps and iterations, and
// with n unknowns between n (assembly) and n² (banded factorization; nested dissection, n^1.5, lies
// between: George (1973), SIAM J. Numer. Anal. 10, 345-363).
TEST(ResourceEstimate, TimesGrowAsTheWork) {
  const auto motion = [](const std::string& step, const std::string& elements) {
    return seconds_of("plate_pendulum", {"output.motion_every=1e9", "time.step=" + step,
                                         "body.elements=[" + elements + ", " + elements + "]"});
  };
  // The start of the program takes constant time: 0.25 s of more than 25 s.
  EXPECT_NEAR(motion("1e-6", "20") / motion("2e-6", "20"), 2, 0.02);
  const double finer = motion("1e-5", "40") / motion("1e-5", "20");
  EXPECT_GT(finer, 4);
  EXPECT_LT(finer, 16);
  const auto design = [](const std::string& iterations, const std::string& cell) {
    return seconds_of("short_beam",
                      {"optimizer.max_iterations=" + iterations, "design.cell=" + cell});
  };
  EXPECT_NEAR(design("80000", "0.025") / design("40000", "0.025"), 2, 0.02);
  // On small cells the exact outlines, which do not depend on the cells, cost little.
  const double smaller = design("4000", "0.003125") / design("4000", "0.00625");
  EXPECT_GT(smaller, 4);
  EXPECT_LT(smaller, 16);
}

// 2^31 steps and more are counted correctly, but refused.
TEST(ResourceEstimate, StepsAreCountedBeyondAllIntegers) {
  const Machine endless{INFINITY, INFINITY};
  try {  // refused before drives are evaluated
    read("free_beam_heated", {"time.step=1e-12"});
    FAIL();
  } catch (const Error& e) {
    EXPECT_TRUE(testing::mentions_all(e.what(), {"1e+12", "2.15e+09"}, "--set time.step=1e-12: "));
  }
  EXPECT_EQ(estimate_resources(read("free_beam_heated", {"output.motion_every=1e-11"})).steps,
            1e11);
  EXPECT_TRUE(testing::mentions_all(
      complaint(read("free_beam_heated", {"output.motion_every=1e-11"}), endless),
      {"1e+11", "2.15e+09"}, "--set output.motion_every=1e-11: "));
  EXPECT_EQ(complaint(read("free_beam_heated", {"time.step=1e-9"}), endless), "");
}

TEST(ResourceEstimate, WhatAMachineHasNotIsRefusedAtTheNumberToBlame) {
  struct Row {
    const char* name;
    Changes changes;
    Machine machine;
    std::string location;
    std::vector<std::string> parts;
  };
  const std::string folder = FLEXMORPH_CASES;
  const std::string four_bar = folder + "/four_bar.toml:", beam = folder + "/short_beam.toml:";
  for (const Row& row :
       std::vector<Row>{{"four_bar",
                         {"time.step=1e-7"},
                         {1e9, kPlenty},
                         "--set time.step=1e-7: ",
                         {"GB", "memory"}},
                        {"four_bar",
                         {"body.elements=[300, 300]"},
                         {1e9, kPlenty},
                         "--set body.elements=[300, 300]: ",
                         {"mesh", "'rocker'", "1 GB"}},
                        {"free_beam_heated",
                         {"body.elements=100000"},
                         {2e10, kPlenty},
                         "--set body.elements=100000: ",
                         {"thermal force", "'beam'", "20 GB"}},
                        {"four_bar",
                         {"verify="},
                         {9e7, kPlenty},
                         four_bar + "123:9: esl.every = ",
                         {"loads", "'rocker'", "90 MB"}},
                        {"four_bar",
                         {"cycle.max_cycles=1"},
                         {kPlenty, 1e6},
                         four_bar,
                         {"disk", "motion", "1 MB"}},
                        {"short_beam",
                         {"design.cell=0.00125"},
                         {1e9, kPlenty},
                         "--set design.cell=0.00125: ",
                         {"design", "'beam'", "1 GB"}},
                        {"short_beam", {}, {kPlenty, 1e6}, beam, {"disk", "'beam'", "1 MB"}},
                        {"plate_pendulum",
                         {"output.motion_every=1e-5"},
                         {kPlenty, 1e8},
                         "--set output.motion_every=1e-5: ",
                         {"disk", "100 MB"}}}) {
    const std::string found = complaint(read(row.name, row.changes), row.machine);
    EXPECT_TRUE(testing::mentions_all(found, row.parts, row.location));
    EXPECT_EQ(complaint(read(row.name, row.changes), {kPlenty, kPlenty}), "") << row.name;
  }
}

TEST(ResourceEstimate, ThisMachineHasSome) {
  const Machine here = this_machine(), nowhere = this_machine("no/such/folder/yet");
  EXPECT_GT(here.memory, 1e8);  // with less memory this test could not have been built
  EXPECT_GT(here.disk, 0);
  EXPECT_NEAR(nowhere.disk, here.disk, 1e9);  // other processes write meanwhile
  EXPECT_EQ(here.disk > 1e6,
            std::filesystem::space(std::filesystem::current_path()).available > 1'000'000);
}

TEST(ResourceEstimate, SizesAreSaidInTheirUnits) {
  EXPECT_EQ(bytes_text(12'300), "12.3 kB");
  EXPECT_EQ(bytes_text(1.26e9), "1.3 GB");
  EXPECT_EQ(bytes_text(3e20), "3e+05 PB");
  EXPECT_EQ(duration_text(1.26), "1.3 s");
  EXPECT_EQ(duration_text(99.4), "99 s");
  EXPECT_EQ(duration_text(99.6), "100 s");
  EXPECT_EQ(duration_text(600), "10 min");
  EXPECT_EQ(duration_text(7100), "118 min");
  EXPECT_EQ(duration_text(3 * 3600), "3 h");
  EXPECT_EQ(duration_text(1e6), "11.6 days");
}

}  // namespace
}  // namespace flexmorph::cases
