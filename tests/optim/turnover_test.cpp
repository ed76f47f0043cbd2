// Components that leave a design without a trace go, at the second look; halves of a component are
// the component.

#include "optim/mmc/turnover.h"

#include <gtest/gtest.h>

#include "geometry/picture.h"
#include "optim/mmc/compliance_evaluator.h"
#include "tests/optim/mmc_small.h"

namespace flexmorph::mmc::test {
namespace {

Component bar(double x, double half_length, double thickness, double y = 0) {
  return {{x, y}, half_length, 0, thickness, thickness, thickness};
}

Turnover turnover(double min_half_length = 0) {
  return {kGrid, tdf_settings(), Ersatz(kGrid, tdf_settings().alpha, {}, {}), min_half_length};
}

TEST(Turnover, DropsWhatIsOutsideOrUnderOthersAtTheSecondLook) {
  const std::vector<Component> all = {bar(0.3, 0.25, 0.045), bar(0.3, 0.05, 0.01),
                                      bar(0.3, 0.05, 0.01, 0.3), bar(0.55, 0.1, 0.01)};
  Turnover looks = turnover();
  EXPECT_FALSE(looks.look(all));
  ASSERT_TRUE(looks.look(all));
  ASSERT_EQ(looks.events().size(), 2U);
  EXPECT_EQ(looks.events()[0].kind, ComponentEvent::Kind::hidden);
  EXPECT_EQ(looks.events()[0].component, 1);
  EXPECT_EQ(looks.events()[1].kind, ComponentEvent::Kind::outside);
  EXPECT_EQ(looks.events()[1].component, 2);
  EXPECT_EQ(looks.events()[1].n_components, 2);
  ASSERT_EQ(looks.next().size(), 2U);
  EXPECT_EQ(looks.next()[0].center, all[0].center);
  EXPECT_EQ(looks.next()[1].center, all[3].center);
  EXPECT_FALSE(looks.look(looks.next()));
  EXPECT_FALSE(looks.look(looks.next()));
}

TEST(Turnover, AComponentThatComesBackStays) {
  std::vector<Component> all = {bar(0.3, 0.25, 0.045), bar(0.3, 0.05, 0.01)};
  Turnover looks = turnover();
  EXPECT_FALSE(looks.look(all));
  all[1].center.x() = 0.57;
  EXPECT_FALSE(looks.look(all));
  all[1].center.x() = 0.3;
  EXPECT_FALSE(looks.look(all));
  EXPECT_TRUE(looks.look(all));
}

// Two wide bars, each under the other but for its ends, which two more cover: both are without
// trace by themselves, and without both there is a hole.
TEST(Turnover, TwoThatHideEachOtherDoNotBothGo) {
  const std::vector<Component> all = {bar(0.29, 0.12, 0.08), bar(0.31, 0.12, 0.08),
                                      bar(0.12, 0.12, 0.08), bar(0.48, 0.12, 0.08)};
  Turnover looks = turnover();
  looks.look(all);
  ASSERT_TRUE(looks.look(all));
  EXPECT_EQ(looks.next().size(), 3U);
}

TEST(Turnover, SplitsTheLongestInsteadAndStopsAtTheShortest) {
  const std::vector<Component> all = {bar(0.3, 0.25, 0.045), bar(0.3, 0.05, 0.01),
                                      bar(0.3, 0.04, 0.01)};
  Turnover looks = turnover(0.1);
  looks.look(all);
  ASSERT_TRUE(looks.look(all));
  EXPECT_EQ(looks.next().size(), 2U);  // halves of 0.1375, whose halves were too short
  EXPECT_EQ(looks.events().back().kind, ComponentEvent::Kind::split);
  EXPECT_NEAR(looks.next()[0].half_length, 0.1375, 1e-15);
}

// The halves of a parabola are parabolas: apart from the two round tips in the middle the
// picture stays.
TEST(Split, HalvesAreTheComponent) {
  const Component c{{0.3, 0}, 0.2, 0.1, 0.01, 0.02, 0.015};
  const std::vector<Component> halves = split(c, 0.001);
  const VectorXd whole = area_fractions(kGrid, {&c, 1}, 0.001, {}, {}, 32);
  const VectorXd both = area_fractions(kGrid, halves, 0.001, {}, {}, 32);
  EXPECT_NEAR(both.sum(), whole.sum(), 0.02 * whole.sum());
  const double shift = c.half_length - halves[0].half_length;
  for (const double x : {-0.19, -0.1, -0.01, 0.015}) {
    EXPECT_NEAR(profile(halves[0], x + shift, 0.001).g, profile(c, x, 0.001).g, 1e-15);
    EXPECT_NEAR(profile(halves[1], -x - shift, 0.001).g, profile(c, -x, 0.001).g, 1e-15);
  }
}

TEST(BodyDesign, GoesOnWithoutADeadComponent) {
  std::vector<Component> start = layout();
  start.push_back(bar(0.3, 0.05, 0.01, 0.3));
  // Centres may lie outside of the grid here.
  const Grid wide{.x0 = 0, .y0 = -1, .width = 0.6, .height = 2, .nx = 60, .ny = 200};
  BodyProblem problem = body_of(Design(wide, start, kScale), {tdf_settings()});
  problem.drop_every = 5;
  std::vector<fem::HeldUnknown> held;
  for (int j = 0; j <= kGrid.ny; ++j)
    for (int c = 0; c < 2; ++c) held.push_back({kGrid.node(0, j), c});
  const std::vector<LoadCase> loads = {{"tip", 1, {{kGrid.node(60, 5), Vec2(0, 1)}}}};
  ComplianceEvaluator statics({kGrid, kSection, {}}, held, loads, false);
  DesignSettings settings;
  settings.optimizer.max_iterations = 20;
  bool going = true;
  std::vector<int> n_components;
  const auto watch = [&](const IterationReport& r) {
    n_components.push_back(static_cast<int>(r.state.components().size()));
    return true;
  };
  const BodyOutcome outcome = design_body(problem, statics, 1, settings, watch, going);
  ASSERT_EQ(n_components.size(), 20U);
  EXPECT_EQ(n_components[9], 25);
  EXPECT_EQ(n_components[10], 24);
  EXPECT_EQ(problem.design.n_components(), 24);
  ASSERT_GE(outcome.events.size(), 1U);
  EXPECT_EQ(outcome.events[0].kind, ComponentEvent::Kind::outside);
  EXPECT_EQ(outcome.events[0].component, 24);
  EXPECT_EQ(outcome.iterations, 20);
}

// A bar on the line of symmetry lies under its own image: that is no reason to drop both.
TEST(Turnover, ComponentsGoWithTheirImages) {
  const Symmetry symmetry{{}, kGrid.y0 + 0.5 * kGrid.height};
  const double y = *symmetry.y;
  const Design design(kGrid,
                      {bar(0.3, 0.25, 0.012, y), bar(0.15, 0.12, 0.03, y - 0.015),
                       bar(0.15, 0.05, 0.01, y - 0.015)},
                      kScale, symmetry);
  ASSERT_EQ(design.n_components(), 6);
  Turnover looks(kGrid, tdf_settings(), Ersatz(kGrid, tdf_settings().alpha, {}, {}), 0, 2);
  EXPECT_FALSE(looks.look(design.components()));
  ASSERT_TRUE(looks.look(design.components()));
  ASSERT_EQ(looks.events().size(), 1U);
  EXPECT_EQ(looks.events()[0].component, 2);
  EXPECT_EQ(looks.events()[0].n_components, 4);
  const Design next = design.with(looks.next());
  EXPECT_EQ(next.n_components(), 4);
  EXPECT_TRUE(is_symmetric(next.components(), symmetry));
}

}  // namespace
}  // namespace flexmorph::mmc::test
