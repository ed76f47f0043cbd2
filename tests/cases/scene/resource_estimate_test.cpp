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
  /// Memory in run.json and size of the run folder [MB]; 0: not compared, because the run ended
  /// before its limits.
  double memory, disk;
};

Changes moves_only(Changes more) {
  for (const char* part : {"design=", "esl=", "optimizer=", "cycle=", "verify=", "accuracy="})
    more.emplace_back(part);
  return more;
}

// Measured with one thread, -O3 -march=native, November 2026. A factor of two is accurate enough
// for a warning.
TEST(ResourceEstimate, IsThatOfMeasuredRuns) {
  const std::vector<Measured> all = {
      {"cantilever_roll_up", {}, 39.1, 0.47},
      {"square_plate_twist", {}, 47.9, 0.81},
      {"plate_pendulum", {}, 47.4, 3.29},
      {"plate_pendulum", {"body.elements=[40,40]", "time.end=0.004"}, 244, 6.2},
      {"plate_pendulum", {"body.elements=[80,80]", "time.end=0.002"}, 886, 24.9},
      {"deploying_plate", {"body.flow.mesh=split"}, 47.4, 1.71},
      {"elastic_sleeve", {}, 37.9, 0.70},
      {"rotating_plate_v01",
       moves_only({"body.elements=[100,20]", "body.flow.max_length=0.01", "time.end=0.02"}), 199,
       2.46},
      {"four_bar", {"verify="}, 134, 0},
      {"telescopic_crane", {"body.0.flow.mesh=split", "cycle.max_cycles=1", "verify="}, 360, 0},
      {"motion_platform", {"cycle.max_cycles=1", "verify={refine=2}"}, 431, 0},
      {"rotating_plate_v01", {"cycle.max_cycles=1", "verify={mesh=[20,4]}"}, 105, 0},
      {"rotating_plate_v01", {"cycle.max_cycles=1"}, 202, 43.9},
      {"rotating_plate_v01", {"cycle.max_cycles=2"}, 339, 0},
      {"short_beam", {}, 47.1, 0},
      {"short_beam", {"design.cell=0.00625", "optimizer.max_iterations=10"}, 182, 0},
      {"bridge", {}, 57, 0},
  };
  for (const Measured& each : all) {
    const ResourceEstimate resource_estimate = estimate_resources(read(each.name, each.changes));
    const auto near = [&](double found, double measured, const char* what) {
      if (measured == 0) return;
      EXPECT_LT(found, 2 * measured) << each.name << ": " << what;
      EXPECT_GT(found, measured / 2) << each.name << ": " << what;
    };
    near(resource_estimate.memory_bytes() / kMega, each.memory, "memory");
    near(resource_estimate.disk_bytes() / kMega, each.disk, "disk");
  }
}

double seconds_of(const std::string& name, const Changes& changes) {
  const Scene scene = read(name, changes);
  std::optional<Mechanism> built;
  if (!scene.domain) built = build_mechanism(scene);
  return expected_seconds(scene, built ? &*built : nullptr);
}

// Expected times grow with the work, on every processor: in proportion to steps and iterations, and
// with n unknowns between n (assembly) and n² (banded factorization; nested dissection, n^1.5, lies
// between: George (1973), SIAM J. Numer. Anal. 10, 345-363).
TEST(ResourceEstimate, TimesGrowAsTheWork) {
  const auto motion = [](const std::string& step, const std::string& elements) {
    return seconds_of("plate_pendulum", {"output.motion_every=1e9", "time.step=" + step,
                                         "body.elements=[" + elements + ", " + elements + "]"});
  };
  // The start of the program takes constant time: 0.1 s of more than 5 s.
  EXPECT_NEAR(motion("5e-6", "20") / motion("1e-5", "20"), 2, 0.02);
  const double finer = motion("1e-5", "40") / motion("1e-5", "20");
  EXPECT_GT(finer, 4);
  EXPECT_LT(finer, 16);
  const auto design = [](const std::string& iterations, const std::string& cell) {
    return seconds_of("short_beam",
                      {"optimizer.max_iterations=" + iterations, "design.cell=" + cell});
  };
  EXPECT_NEAR(design("8000", "0.025") / design("4000", "0.025"), 2, 0.02);
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
  EXPECT_EQ(duration_text(600), "10 min");
  EXPECT_EQ(duration_text(3 * 3600), "3 h");
  EXPECT_EQ(duration_text(1e6), "11.6 days");
}

}  // namespace
}  // namespace flexmorph::cases
