// Shows that unloaded components are removed together with their images, and that loaded components
// stay.

#include "optim/mmc/length_scale/unloaded_components.h"

#include <gtest/gtest.h>

#include "tests/optim/mmc_small.h"

namespace flexmorph::mmc::test {
namespace {

/// Returns two chords from the support to the load.
std::vector<Component> frame() {
  return {bar({-0.02, 0.042}, {0.61, 0.01}, 0.01), bar({-0.02, -0.042}, {0.61, -0.01}, 0.01)};
}

BodyProblem problem_of(const Design& design) {
  BodyProblem out = body_of(design, {tdf_settings(1)});
  out.widths.solid = 0.016;
  return out;
}

TEST(IdleComponents, IslandsAndDeadEndsGoAndNothingElse) {
  std::vector<Component> all = frame();
  all.push_back(bar({0.02, 0}, {0.06, 0}, 0.005));            // a separate region
  all.push_back(bar({0.12, -0.036}, {0.12, -0.006}, 0.005));  // a dangling end
  all.push_back(bar({0.1, 0.0359}, {0.12, 0.0349}, 0.004));   // hidden within a chord
  Design design(kGrid, {}, kScale);
  design = design.with(all);
  const BodyProblem problem = problem_of(design);
  ComplianceEvaluator loads = tip_load();
  const std::vector<int> removed = remove_unloaded_components(problem, loads, design);
  EXPECT_EQ(removed, (std::vector<int>{2, 3, 4}));
  EXPECT_EQ(design.n_components(), 2);
  EXPECT_TRUE(remove_unloaded_components(problem, loads, design).empty());
  const Connectivity left = connectivity_of(
      problem, regions_of(problem, design.components(), kOutlineTolerance * kGrid.dx()));
  EXPECT_TRUE(left.connected);
  EXPECT_EQ(left.islands, 0);
}

// A bar in the slot of an unloaded solid region is unloaded, too. But without it the opening of the
// slot is a gap of 2 mm, and the minimum gap is 4 mm.
TEST(IdleComponents, StayWhereTheyKeepWidths) {
  std::vector<Component> all = frame();
  all.push_back(bar({0.085, 0}, {0.125, 0}, 0.004));
  const Design design = Design(kGrid, {}, kScale).with(all);
  BodyProblem problem = problem_of(design);
  problem.widths.gap = 0.004;
  problem.solid = {{{0.06, -0.02},
                    {0.12, -0.02},
                    {0.12, -0.001},
                    {0.08, -0.003},
                    {0.08, 0.003},
                    {0.12, 0.001},
                    {0.12, 0.02},
                    {0.06, 0.02}}};
  ComplianceEvaluator loads = tip_load();
  Design any = design, kept = design;
  EXPECT_EQ(remove_unloaded_components(problem, loads, any), std::vector<int>{2});
  EXPECT_TRUE(remove_unloaded_components(problem, loads, kept, true).empty());
  EXPECT_EQ(kept.n_components(), 3);
}

TEST(IdleComponents, GoWithTheirImages) {
  // One half: a chord, half of a post that crosses the axis, and a dangling end.
  const std::vector<Component> half = {bar({-0.02, -0.03}, {0.61, -0.005}, 0.01),
                                       bar({0.2, -0.03}, {0.2, 0.03}, 0.008),
                                       bar({0.4, -0.02}, {0.44, -0.046}, 0.004)};
  Symmetry axis;
  axis.y = 0;
  Design design = Design(kGrid, {}, kScale, axis).with(half);
  ASSERT_EQ(design.n_images(), 2u);
  const int before = design.n_components();
  const BodyProblem problem = problem_of(design);
  ComplianceEvaluator loads = tip_load();
  const std::vector<int> removed = remove_unloaded_components(problem, loads, design);
  EXPECT_EQ(removed, (std::vector<int>{2, 2 + before / 2}));
  EXPECT_EQ(design.n_components(), before - 2);
  EXPECT_TRUE(is_symmetric(design.components(), axis));
}

}  // namespace
}  // namespace flexmorph::mmc::test
