// Compares the program's designs with those of a density method: one problem, equal loads and
// volume, and one verification for both outlines. Prints a table; the command is in
// tests/README.md.

#include <gtest/gtest.h>

#include <cstdio>

#include "tests/benchmark/compared_case.h"
#include "tests/benchmark/density_outline.h"
#include "tests/io/scratch.h"

namespace flexmorph::benchmark {
namespace {

constexpr const char* kStrip = R"(
title = "Strip with a load at its tip"
[domain]
name = "strip"
size = [0.6, 0.1]
thickness = 0.01
youngs_modulus = 1e8
poisson_ratio = 0.3
[[support]]
edge = "left"
fix = ["x", "y"]
[[load]]
name = "tip"
[[load.force]]
point = [0.6, 0.05]
force = [0.0, -1.0]
[[design]]
cell = 0.005
components = [12, 2]
max_volume = 0.5
min_thickness = 0.005
band = [2.5, 1.5]
erosion_width = 0.0
[optimizer]
name = "mma"
max_iterations = 300
)";

/// Least projection of the stages whose outlines are compared; which of them is best differs from
/// case to case.
constexpr double kFirstOutline = 4;

/// Returns the outline with the least compliance of the last stages, at a given area; its seconds
/// are those of all stages. (Thin members that remain grey in the last stages are cut by their
/// outlines.)
ComparedDesign best_by_densities(ComparedCase& of, double allowed, double threshold) {
  DensitySettings settings;
  settings.stages = density_stages(threshold);
  std::vector<DensityDesign> stages =
      design_by_densities(density_plate(of.problem), *of.loads, settings);
  ComparedDesign best;
  best.verdict.compliance = INFINITY;
  for (const DensityDesign& stage : stages) {
    if (stage.stage.projection < kFirstOutline) continue;
    ComparedDesign found =
        compared(of, outline_of(of.problem, stage.densities.filtered, allowed).regions,
                 stages.back().seconds);
    std::printf("    projection %2.0f: cells %.5g, outline %.5g, %d pieces\n",
                stage.stage.projection, stage.compliance, found.verdict.compliance,
                found.verdict.n_connected_regions);
    if (found.verdict.compliance < best.verdict.compliance) best = std::move(found);
  }
  return best;
}

void print(const char* method, const ComparedDesign& d, double cell) {
  std::printf("  %-10s %10.5g  +-%.2f %%  volume %.4f  width %.2f  gap %.2f cells  CPU %.1f s\n",
              method, d.verdict.compliance, 100 * d.verdict.error, d.volume, d.feature / cell,
              d.gap / cell, d.seconds);
  std::fflush(stdout);
}

class BesideDensities : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Cases, BesideDensities,
                         ::testing::Values("short_beam", "mbb", "l_bracket", "bridge", "strip",
                                           "rotating_plate_v05"),
                         [](const auto& test) { return std::string(test.param); });

// The test checks that designs have equal volumes; their quality is printed in the table.
TEST_P(BesideDensities, IsPrinted) {
  const std::string name = GetParam();
  const Scratch scratch;
  ComparedCase of(name == "strip" ? scratch.write("strip.toml", kStrip) : name, {});
  const double cell = of.problem.grid.dx();
  std::printf("%s, %d x %d cells\n", name.c_str(), of.problem.grid.nx, of.problem.grid.ny);
  // This design is made first, because the loads of a motion belong to the first design of the
  // case.
  const ComparedDesign own = design_by_components(of);
  print("components", own, cell);
  EXPECT_TRUE(own.verdict.converged);
  EXPECT_EQ(own.verdict.n_omitted_regions, 0);
  EXPECT_NEAR(own.volume, *mmc::allowed_volume(of.problem.goal), 1e-3 * own.volume);
  // Two density designs: with the stiffness of the densities themselves, and with that of an eroded
  // design, which has wider members.
  for (const double threshold : {0.5, 0.6}) {
    const ComparedDesign other = best_by_densities(of, area(own.regions), threshold);
    print(threshold > 0.5 ? "eroded" : "densities", other, cell);
    std::printf("  ratio %.4f\n", own.verdict.compliance / other.verdict.compliance);
    std::fflush(stdout);
    EXPECT_NEAR(other.volume, own.volume, 1e-5 * own.volume);
  }
}

}  // namespace
}  // namespace flexmorph::benchmark
