// Shows that the exported part widens violations of the minimum width if they are few, and leaves
// them if the design is far from its widths.

#include "optim/mmc/problem/finished_part.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "tests/optim/mmc_small.h"

namespace flexmorph::mmc::test {
namespace {

constexpr double kFeature = 0.016, kTolerance = 1e-5;

/// Returns a bar made of n bars whose rounded ends overlap by `overlap`.
std::vector<Component> chain(int n, double overlap) {
  const double length = kGrid.width / n;
  std::vector<Component> out;
  for (int k = 0; k < n; ++k)
    out.push_back(
        bar({k * length - 0.5 * overlap, 0}, {(k + 1) * length + 0.5 * overlap, 0}, 0.012));
  return out;
}

BodyProblem problem_of(double fillets) {
  BodyProblem out = body_of(Design(kGrid, {}, kScale), {tdf_settings(1)});
  out.widths.solid = kFeature;
  out.fillets = {fillets, 0.9 * kFeature};
  return out;
}

double feature(const BodyProblem& problem, const std::vector<Region>& regions) {
  return features_of(problem, regions).solid;
}

/// Returns the bar of n bars whose necks are just above a width.
std::vector<Component> with_necks(int n, double width) {
  const BodyProblem problem = problem_of(0);
  double low = 0, high = 0.03;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    const std::vector<Region> regions = regions_of(problem, chain(n, middle), kTolerance);
    (regions.size() > 1 || feature(problem, regions) < width ? low : high) = middle;
  }
  return chain(n, high);
}

// Fillets of a tenth of the feature size hardly change the neck. An added disc gives it the
// required width.
TEST(FinishedPart, IsAsWideAsAsked) {
  const std::vector<Component> components = with_necks(2, 0.75 * kFeature);
  const BodyProblem problem = problem_of(0.1 * kFeature);
  const std::vector<Region> given = with_fillets(regions_of(problem, components, kTolerance),
                                                 domain_of(problem), problem.fillets, kTolerance);
  ASSERT_LT(feature(problem, given), 0.95 * kFeature);
  const FinishedPart part = finished_part(problem, components, kTolerance);
  EXPECT_GE(part.widened, 1);
  EXPECT_TRUE(part.has_widths);
  EXPECT_GE(feature(problem, part.regions), 0.99 * kFeature);
  EXPECT_LT(area(part.regions), area(given) + kFeature * kFeature);
}

// With seven necks the design is far from its widths: only fillets are applied.
TEST(FinishedPart, IsLeftFarFromItsWidths) {
  const std::vector<Component> components = with_necks(8, 0.75 * kFeature);
  const BodyProblem problem = problem_of(0.02 * kFeature);
  const std::vector<Region> given = with_fillets(regions_of(problem, components, kTolerance),
                                                 domain_of(problem), problem.fillets, kTolerance);
  ASSERT_LT(feature(problem, given), 0.95 * kFeature);
  const FinishedPart part = finished_part(problem, components, kTolerance);
  EXPECT_EQ(part.widened, 0);
  EXPECT_FALSE(part.has_widths);
  EXPECT_EQ(area(part.regions), area(given));
}

// Fillets close a gap between two ends or leave it open. At some gaps the closing leaves two tips
// that touch in the middle and are thinner than half of the feature size.
TEST(FinishedPart, ClosesAGapToTheFullWidthOrNotAtAll) {
  const BodyProblem problem = problem_of(0.8 * kFeature);
  int closed = 0, thin = 0;
  for (const double gap : {0.1, 0.2, 0.3, 0.35, 0.4, 0.45, 0.5, 0.6, 0.8, 1.4}) {
    const std::vector<Component> components = chain(2, -gap * kFeature);
    const std::vector<Region> apart = regions_of(problem, components, kTolerance);
    ASSERT_EQ(apart.size(), 2u);
    const std::vector<Region> given =
        with_fillets(apart, domain_of(problem), problem.fillets, kTolerance);
    if (given.size() == 2) continue;
    ++closed;
    thin += feature(problem, given) < 0.5 * kFeature;
    const FinishedPart part = finished_part(problem, components, kTolerance);
    EXPECT_GE(feature(problem, part.regions), 0.99 * kFeature) << gap << " of the feature";
    EXPECT_TRUE(part.has_widths);
  }
  EXPECT_GE(closed, 3);
  EXPECT_GE(thin, 1);
}

// Without fillets the part is the union of its components.
TEST(FinishedPart, IsTheUnionWithoutFillets) {
  const BodyProblem problem = problem_of(0);
  const std::vector<Component> components = chain(2, 0.02);
  EXPECT_EQ(area(part_of(problem, components, kTolerance)),
            area(regions_of(problem, components, kTolerance)));
  EXPECT_EQ(part_fractions(problem, components), fractions_of(problem, components));
}

// A solid strip of 4 mm at the free end is narrower than required, and no component can change it.
TEST(FinishedPart, NamesTheWidthOfSolidRegionsThatAreTooNarrow) {
  BodyProblem problem = problem_of(0);
  const std::vector<Component> components = {bar({-0.01, 0}, {0.61, 0}, 0.012)};
  for (const double width : {0.004, 0.02}) {
    problem.solid = {corners_of({{0.6 - width, -0.05}, {0.6, 0.05}})};
    const std::vector<Region> part = regions_of(problem, components, kTolerance);
    EXPECT_GE(feature(problem, part), 0.99 * kFeature);
    const std::optional<double> given = given_width_of(problem, part);
    ASSERT_EQ(given.has_value(), width < kFeature);
    if (given) {
      EXPECT_NEAR(*given, width, 1e-9);
    }
  }
  problem.widths.solid = 0;
  EXPECT_FALSE(given_width_of(problem, regions_of(problem, components, kTolerance)));
}

// The mass of a part without its pins: a full rectangle with a bore weighs rho t (W H - pi r^2).
// The polygon of the bore lies within 1 um of the circle, which changes the mass by less than 2e-6.
TEST(FinishedPart, WeighsNoPins) {
  BodyProblem problem = problem_of(0);
  const double radius = 0.01;
  problem.bores = {circle_within({0.02, 0}, radius, 1e-6)};
  std::vector<Vec2> hole = problem.bores[0];
  std::reverse(hole.begin(), hole.end());
  problem.domain = {
      corners_of({{kGrid.x0, kGrid.y0}, {kGrid.x0 + kGrid.width, kGrid.y0 + kGrid.height}}),
      {hole}};
  const std::vector<Component> all = {bar({-0.1, 0}, {0.7, 0}, 0.2)};
  const std::vector<Region> part = part_of(problem, all, kTolerance);
  const double weight = kSection.density * kSection.thickness,
               exact = weight * (kGrid.width * kGrid.height - std::numbers::pi * radius * radius);
  EXPECT_NEAR(part_mass_of(problem, area(part) / area(domain_of(problem))), exact, 1e-5 * exact);
  EXPECT_GT(full_mass_of(problem), exact * (1 + 2e-3));
}

}  // namespace
}  // namespace flexmorph::mmc::test
