// Designs with thin places on purpose: after the clean-up the union, measured anew, is as thick as
// wanted, holds together and weighs no more than allowed; runs agree bit for bit.

#include "optim/mmc/clean_up.h"

#include <gtest/gtest.h>

#include "optim/mmc/body_design.h"
#include "optim/mmc/fixed_loads.h"
#include "tests/geometry/scrambled_heap.h"
#include "tests/optim/mmc_small.h"

namespace flexmorph::mmc::test {
namespace {

constexpr double kWanted = 0.018;  // thinner than the strip of two cells

Component bar(const Vec2& from, const Vec2& to, double half_thickness) {
  const Vec2 along = to - from;
  return {0.5 * (from + to), 0.5 * along.norm(), std::atan2(along.y(), along.x()),
          half_thickness,    half_thickness,     half_thickness};
}

FixedLoads tip_load() {
  std::vector<fem::HeldUnknown> held;
  for (int j = 0; j <= kGrid.ny; ++j)
    for (int c = 0; c < 2; ++c) held.push_back({kGrid.node(0, j), c});
  const std::vector<LoadCase> loads = {{"tip", 1, {{kGrid.node(60, 5), Vec2(0, 1)}}}};
  return {kGrid, kSection, {}, held, loads, false};
}

BodyProblem problem_of(const std::vector<Component>& components, double max_volume) {
  DesignScale scale = kScale;
  scale.half_length = 0.02;  // the shortest is 12 mm
  TdfSettings tdf = tdf_settings();
  tdf.erosion = 0;
  return body_of(Design(kGrid, {}, scale).with(components), {tdf}, least_compliance(max_volume));
}

Features measured(const BodyProblem& p) {
  // Finer outlines than those the clean-up works with.
  return smallest_features(regions_of(p, p.design.components(), 5e-3 * kGrid.dx()), domain_of(p));
}

void expect_thick(BodyProblem& problem, double cost_at_most) {
  FixedLoads loads = tip_load();
  const double before = measured(problem).solid;
  ASSERT_LT(before, kWanted);
  const CleanUp done = clean_up(problem, loads, kWanted);
  EXPECT_TRUE(done.reached());
  EXPECT_GE(measured(problem).solid, kWanted);
  EXPECT_NEAR(done.before, before, 0.02 * kGrid.dx() + 1e-9);
  const SharpDesign sharp = sharp_design(problem, problem.design.components(), loads);
  EXPECT_TRUE(sharp.connectivity.connected);
  EXPECT_LE(sharp.volume,
            *allowed_volume(problem.goal) + 0.01);  // the blurred volume is what counts
  EXPECT_NEAR(sharp.compliance, done.compliance_after, 1e-9 * sharp.compliance);
  EXPECT_LE(done.compliance_after, (1 + cost_at_most) * done.compliance_before);
}

TEST(CleanUp, FillsTheNeckOfTwoBarsThatMeetByTheirTips) {
  BodyProblem problem =
      problem_of({bar({-0.02, 0}, {0.3003, 0}, 0.016), bar({0.2997, 0}, {0.6, 0}, 0.016)}, 0.9);
  expect_thick(problem, 0);  // there is volume to spare, and the neck was weak
}

TEST(CleanUp, ThickensAThinBarAndTakesTheVolumeElsewhere) {
  const std::vector<Component> start = {bar({-0.02, 0.02}, {0.62, 0.02}, 0.02),
                                        bar({-0.02, -0.035}, {0.6, 0.005}, 0.007)};
  BodyProblem problem = problem_of(start, 0.56);
  expect_thick(problem, 0.2);
  EXPECT_LT(problem.design.components()[0].c1, 0.02);
}

TEST(CleanUp, WidensAStripAlongTheBorder) {
  BodyProblem problem = problem_of(
      {bar({-0.02, 0.02}, {0.62, 0.0}, 0.02), bar({-0.1, -0.052}, {0.7, -0.052}, 0.012)}, 0.9);
  expect_thick(problem, 0.01);
}

TEST(CleanUp, LeavesAThickDesignAlone) {
  const std::vector<Component> start = {bar({-0.1, 0}, {0.7, 0}, 0.02)};
  BodyProblem problem = problem_of(start, 0.9);
  FixedLoads loads = tip_load();
  const CleanUp done = clean_up(problem, loads, kWanted);
  EXPECT_EQ(done.rounds, 0);
  EXPECT_TRUE(done.reached());
  EXPECT_EQ(done.compliance_after, done.compliance_before);
  const auto now = problem.design.components()[0].parameters(), then = start[0].parameters();
  for (size_t k = 0; k < now.size(); ++k) EXPECT_NEAR(now[k], then[k], 1e-15);
}

// What is repaired first, and how patches lie, hangs on the last bits of the narrow places.
TEST(CleanUp, IsTheSameBitForBitWhereverTheHeapPutsThings) {
  std::vector<Component> start = random_layout(2);
  start.resize(start.size() / 2);
  start.push_back(bar({0.2, 0}, {0.62, 0}, 0.02));
  flexmorph::test::ScrambledHeap heap(1);
  std::vector<Component> first;
  CleanUp then;
  for (int run = 0; run < 3; ++run) {
    heap.again();
    BodyProblem problem = problem_of(start, 1);
    FixedLoads loads = tip_load();
    const CleanUp done = clean_up(problem, loads, kWanted);
    const std::vector<Component>& now = problem.design.components();
    if (run == 0) {
      EXPECT_GT(done.patches, 0);
      EXPECT_GT(done.after, done.before);
      first = now;
      then = done;
    }
    EXPECT_EQ(done.before, then.before);
    EXPECT_EQ(done.after, then.after);
    EXPECT_EQ(done.compliance_after, then.compliance_after);
    ASSERT_EQ(now.size(), first.size());
    for (size_t k = 0; k < now.size(); ++k)
      EXPECT_EQ(now[k].parameters(), first[k].parameters()) << run << " " << k;
  }
}

TEST(BodyDesign, OfAWantedFeatureIsThatThick) {
  const DesignScale thick{
      .half_length = 0.05, .min_thickness = half_thickness_for(kWanted), .max_thickness = 0.03};
  BodyProblem problem =
      body_of(Design(kGrid, random_layout(2), thick), {tdf_settings()}, least_compliance(0.75));
  problem.min_feature = kWanted;
  problem.stages[0].min_half_thickness = half_thickness_for(kWanted);
  FixedLoads loads = tip_load();
  DesignSettings settings;
  settings.optimizer.max_iterations = 36;
  bool going = true;
  const BodyOutcome outcome = design_body(problem, loads, 1, settings, {}, going);
  ASSERT_TRUE(outcome.clean_up);
  EXPECT_TRUE(outcome.clean_up->reached());
  EXPECT_GE(measured(problem).solid, kWanted);
  EXPECT_LE(outcome.volume, 0.75 * (1 + 1e-4));
  EXPECT_LE(outcome.iterations, 36);
}

}  // namespace
}  // namespace flexmorph::mmc::test
