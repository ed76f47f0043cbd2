// Designs with thin places on purpose: after the clean-up the union, measured anew, is as thick as
// wanted, holds together and weighs no more than allowed; runs agree bit for bit.

#include "optim/mmc/clean_up.h"

#include <gtest/gtest.h>

#include "geometry/line_gaps.h"
#include "optim/mmc/body_design.h"
#include "optim/mmc/corrected_cycles.h"
#include "tests/geometry/scrambled_heap.h"
#include "tests/optim/mmc_small.h"

namespace flexmorph::mmc::test {
namespace {

constexpr double kWanted = 0.018;  // thinner than the strip of two cells
constexpr Widths kWidths{kWanted, 0};

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

double volume_of(const std::vector<Component>& components) {
  const BodyProblem p = problem_of(components, 1);
  return fractions_of(p, components).sum() / kGrid.n_cells();
}

void expect_thick(BodyProblem& problem, double cost_at_most) {
  ComplianceEvaluator loads = tip_load();
  const double before = measured(problem).solid;
  ASSERT_LT(before, kWanted);
  const CleanUp done = clean_up(problem, loads, kWidths);
  EXPECT_TRUE(done.reached());
  EXPECT_GE(measured(problem).solid, kWanted);
  EXPECT_NEAR(done.before.solid, before, 0.02 * kGrid.dx() + 1e-9);
  const SharpDesign sharp = sharp_design(problem, problem.design.components(), loads);
  EXPECT_TRUE(sharp.connectivity.connected);
  EXPECT_LE(sharp.volume, *allowed_volume(problem.goal) * (1 + 1e-3));
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
  BodyProblem problem = problem_of(start, volume_of(start));
  ComplianceEvaluator loads = tip_load();
  const CleanUp done = clean_up(problem, loads, kWidths);
  EXPECT_FALSE(done.changed());
  EXPECT_TRUE(done.reached());
  EXPECT_EQ(done.compliance_after, done.compliance_before);
  const auto now = problem.design.components()[0].parameters(), then = start[0].parameters();
  for (size_t k = 0; k < now.size(); ++k) EXPECT_NEAR(now[k], then[k], 1e-15);
}

TEST(CleanUp, GivesBackVolumeThatIsLeft) {
  const std::vector<Component> start = {bar({-0.1, 0}, {0.7, 0}, 0.02)};
  const double allowed = 1.1 * volume_of(start);
  BodyProblem problem = problem_of(start, allowed);
  ComplianceEvaluator loads = tip_load();
  const CleanUp done = clean_up(problem, loads, kWidths);
  EXPECT_NEAR(done.volume_after, allowed, 1e-3 * allowed);
  EXPECT_LT(done.compliance_after, done.compliance_before);
}

// A slit of 0.3 cells all along is closed; one of 0.7 cells is, or one of the bars goes.
TEST(CleanUp, LeavesNoGapBelowACell) {
  for (const double slit : {0.003, 0.007}) {
    BodyProblem problem =
        problem_of({bar({-0.1, 0.012 + slit / 2}, {0.7, 0.012 + slit / 2}, 0.012),
                    bar({-0.1, -0.012 - slit / 2}, {0.7, -0.012 - slit / 2}, 0.012)},
                   0.9);
    ASSERT_NEAR(measured(problem).gap, slit, 1e-4);
    ComplianceEvaluator loads = tip_load();
    const CleanUp done = clean_up(problem, loads, {kWanted, kGrid.dx()});
    EXPECT_TRUE(done.reached());
    EXPECT_NEAR(done.before.gap, slit, 1e-4);
    const Features now = measured(problem);
    EXPECT_GE(now.gap, 0.985 * kGrid.dx());
    EXPECT_GE(now.solid, kWanted);
    EXPECT_LT(done.compliance_after, done.compliance_before);
  }
}

// A bar that is cut through loses nothing by its cells where the cut is a cell or so wide.
TEST(CleanUp, ClosesACutThroughWhatCarries) {
  BodyProblem problem =
      problem_of({bar({-0.1, 0}, {0.295, 0}, 0.02), bar({0.306, 0}, {0.7, 0}, 0.02)}, 0.9);
  ComplianceEvaluator loads = tip_load();
  const CleanUp done = clean_up(problem, loads, {kWanted, kGrid.dx()});
  EXPECT_EQ(done.pieces_before, 2);  // the strip at the end hangs on the second bar
  EXPECT_EQ(done.pieces_after, 1);
  EXPECT_TRUE(done.reached());
}

/// The small plate's cells, or such as are finer, under the load at its tip.
double compliance_on(int finer, BodyProblem problem) {
  Grid& g = problem.grid;
  g.nx *= finer;
  g.ny *= finer;
  std::vector<fem::HeldUnknown> held;
  for (int j = 0; j <= g.ny; ++j)
    for (int c = 0; c < 2; ++c) held.push_back({g.node(0, j), c});
  const std::vector<LoadCase> load = {{"tip", 1, {{g.node(g.nx, g.ny / 2), Vec2(0, 1)}}}};
  ComplianceEvaluator loads({g, kSection, {}}, held, load, false);
  const VectorXd fractions = fractions_of(problem, problem.design.components());
  return design_compliance(problem, loads, ersatz_of(problem).sharp(fractions));
}

// Both parts of a slanted bar that is cut hang on flanges: the union is one piece, and cells bridge
// the cut, whose sides fill none of them. Cells of a quarter of their size do not.
TEST(CleanUp, ClosesACutThroughASlantedBarThatFillsNoCell) {
  constexpr double kBar = 0.012;
  for (const double gap : {0.0, 0.0106, 0.012, 0.016})
    for (const double half : {0.0075, 0.009, 0.0106}) {
      SCOPED_TRACE(std::to_string(gap) + " " + std::to_string(half));
      std::vector<Component> parts = {
          bar({-0.1, -0.042}, {0.62, -0.042}, 0.008), bar({-0.1, 0.042}, {0.62, 0.042}, 0.008),
          bar({0.03, -0.042}, {0.15, 0.042}, half),   bar({0.27, -0.042}, {0.39, 0.042}, half),
          bar({0.39, 0.042}, {0.51, -0.042}, half),   bar({0.51, -0.042}, {0.6, 0.03}, half)};
      const Vec2 top(0.15, 0.042), low(0.27, -0.042), middle = 0.5 * (top + low),
                                                      along = (low - top).normalized();
      if (gap > 0) {
        parts.push_back(bar(top, middle - 0.5 * gap * along, half));
        parts.push_back(bar(middle + 0.5 * gap * along, low, half));
      } else {
        parts.push_back(bar(top, low, half));
      }
      BodyProblem problem = problem_of(parts, 1);
      problem.goal.limits.clear();
      ComplianceEvaluator loads = tip_load();
      const Widths wanted{kBar, kGrid.dx()};
      const CleanUp found = look_over(problem, loads, wanted);
      EXPECT_EQ(found.pieces_after, 1);
      if (gap == 0) {
        EXPECT_EQ(found.torn, 0);
        EXPECT_TRUE(found.reached());
        continue;
      }
      EXPECT_GE(found.torn, 1);
      EXPECT_FALSE(found.reached());
      EXPECT_GT(compliance_on(4, problem), 1.7 * compliance_on(1, problem));
      const CleanUp done = clean_up(problem, loads, wanted);
      EXPECT_EQ(done.torn, 0);
      EXPECT_TRUE(done.reached());
      EXPECT_LT(compliance_on(4, problem), 1.04 * compliance_on(1, problem));
    }
}

// The cells in front of the line that holds bridge what ends short of it, and a flange that ends
// one or two cells away may well stay there: no derivative calls it back. Of two flanges both are
// needed.
TEST(CleanUp, ClosesACutBeforeTheLineThatHolds) {
  for (const double short_of : {0.00006, 0.004, 0.008, 0.012, 0.017}) {
    SCOPED_TRACE(short_of);
    std::vector<Component> parts = {bar({-0.1, -0.03}, {0.62, -0.03}, 0.012),
                                    bar({short_of, 0.03}, {0.62, 0.03}, 0.012)};
    for (const double x : {0.1, 0.3, 0.5}) {
      parts.push_back(bar({x, -0.03}, {x + 0.1, 0.03}, 0.009));
      parts.push_back(bar({x + 0.1, 0.03}, {x + 0.2, -0.03}, 0.009));
    }
    BodyProblem problem = problem_of(parts, 1);
    problem.goal.limits.clear();
    parts[1] = bar({-0.1, 0.03}, {0.62, 0.03}, 0.012);
    const double uncut = compliance_on(4, problem_of(parts, 1));
    problem.held = {{{kGrid.x0, kGrid.y0}, {kGrid.x0, kGrid.y0 + kGrid.height}}};
    const auto to_root = [&] {
      const auto outline = regions_of(problem, problem.design.components(), 5e-3 * kGrid.dx());
      return line_gaps(outline, problem.held, 3 * kGrid.dx());
    };
    ASSERT_EQ(to_root().size(), 1u);
    EXPECT_NEAR(to_root().front().width, short_of, 1e-4);
    ComplianceEvaluator loads = tip_load();
    const Widths wanted{kWanted, kGrid.dx()};
    EXPECT_FALSE(look_over(problem, loads, wanted).reached());
    if (short_of > kGrid.dx() / 4) {
      EXPECT_GT(compliance_on(4, problem), 1.5 * uncut);
    }
    const CleanUp done = clean_up(problem, loads, wanted);
    EXPECT_TRUE(done.reached());
    EXPECT_TRUE(to_root().empty());
    EXPECT_LT(compliance_on(4, problem), 1.07 * uncut);  // what came is thinner than the bar
  }
}

// A run that is to end does not wait for a repair, and takes nothing half done.
TEST(CleanUp, LeavesTheDesignWhereItWasWhenItIsToStop) {
  BodyProblem problem =
      problem_of({bar({-0.1, 0}, {0.295, 0}, 0.02), bar({0.306, 0}, {0.7, 0}, 0.02)}, 0.9);
  const VectorXd before = problem.design.x();
  ComplianceEvaluator loads = tip_load();
  for (const int steps : {0, 1}) {
    int asked = 0;
    const CleanUp done =
        clean_up(problem, loads, {kWanted, kGrid.dx()}, {.go_on = [&] { return asked++ < steps; }});
    EXPECT_GT(asked, 0);
    EXPECT_TRUE(done.given_up);
    EXPECT_EQ(problem.design.x(), before);
    EXPECT_EQ(done.pieces_after, done.pieces_before);
  }
}

TEST(CleanUp, TakesOutWhatCarriesNothing) {
  const Component beam = bar({-0.1, -0.02}, {0.7, -0.02}, 0.012);
  // One hangs on the beam by its end, the other goes on beyond where it meets the beam.
  const Component idle = bar({0.5, -0.02}, {0.5, 0.035}, 0.012),
                  brace = bar({-0.05, 0.04}, {0.3, -0.025}, 0.012);
  BodyProblem problem = problem_of({beam, idle, brace}, 1);
  problem.goal.limits.clear();
  ComplianceEvaluator loads = tip_load();
  const CleanUp done = clean_up(problem, loads, kWidths);
  EXPECT_EQ(done.idle, 1);
  EXPECT_EQ(problem.design.n_components(), 2);
  EXPECT_LT(done.volume_after, done.volume_before - 0.01);
  EXPECT_LT(done.compliance_after * done.volume_after, done.compliance_before * done.volume_before);
}

TEST(CleanUp, CutsAStub) {
  const Component beam = bar({-0.1, -0.03}, {0.7, -0.01}, 0.012),
                  brace = bar({-0.1, -0.06}, {0.45, 0.045}, 0.012);
  BodyProblem problem = problem_of({beam, brace}, 1);
  problem.goal.limits.clear();
  ComplianceEvaluator loads = tip_load();
  const CleanUp done = clean_up(problem, loads, kWidths);
  EXPECT_GE(done.stubs, 1);
  EXPECT_LT(done.volume_after, done.volume_before - 0.01);
  EXPECT_LT(done.compliance_after * done.volume_after, done.compliance_before * done.volume_before);
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
    ComplianceEvaluator loads = tip_load();
    const CleanUp done = clean_up(problem, loads, kWidths);
    const std::vector<Component>& now = problem.design.components();
    if (run == 0) {
      EXPECT_GT(done.patches, 0);
      EXPECT_GT(done.after.solid, done.before.solid);
      first = now;
      then = done;
    }
    EXPECT_EQ(done.before.solid, then.before.solid);
    EXPECT_EQ(done.after.solid, then.after.solid);
    EXPECT_EQ(done.compliance_after, then.compliance_after);
    ASSERT_EQ(now.size(), first.size());
    for (size_t k = 0; k < now.size(); ++k)
      EXPECT_EQ(now[k].parameters(), first[k].parameters()) << run << " " << k;
  }
}

// One body has a thin bar and no volume to spare, the other has plenty: it may give some only where
// both have one budget.
TEST(CleanUp, GivesNoBodyTheVolumeOfAnotherUnlessTheyShareIt) {
  constexpr double kLittle = 0.56, kMuch = 0.9;
  for (const bool shares : {false, true}) {
    BodyProblem a = problem_of({bar({-0.02, 0.02}, {0.62, 0.02}, 0.02),
                                bar({-0.02, -0.035}, {0.6, 0.005}, 0.007)},
                               kLittle),
                b = problem_of({bar({-0.1, 0}, {0.7, 0}, 0.02)}, kMuch);
    for (BodyProblem* p : {&a, &b}) {
      p->widths = kWidths;
      p->shares_mass = shares;
    }
    ComplianceEvaluator loads_a = tip_load(), loads_b = tip_load();
    const LoadedBody bodies[] = {{a, loads_a}, {b, loads_b}};
    const std::vector<BodyOutcome> out = outcomes_of_corrected(bodies, {});
    const double of_a = out[0].sharp.volume, of_b = out[1].sharp.volume;
    EXPECT_TRUE(out[0].clean_up && out[0].clean_up->reached());
    EXPECT_EQ(of_a > kLittle * (1 + 1e-3), shares) << of_a;
    EXPECT_LE(of_a + of_b, (kLittle + kMuch) * (1 + 1e-3));
  }
}

TEST(BodyDesign, OfAWantedFeatureIsThatThick) {
  const DesignScale thick{
      .half_length = 0.05, .min_thickness = half_thickness_for(kWanted), .max_thickness = 0.03};
  BodyProblem problem =
      body_of(Design(kGrid, random_layout(2), thick), {tdf_settings()}, least_compliance(0.75));
  problem.widths = kWidths;
  problem.stages[0].min_half_thickness = half_thickness_for(kWanted);
  ComplianceEvaluator loads = tip_load();
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
