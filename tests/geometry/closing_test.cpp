// Shows that fillets of outlines have known areas and radii, and that area fractions of polygons
// equal the areas of shapes.
#include "geometry/parts/closing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "geometry/parts/feature.h"
#include "geometry/parts/part_mesh.h"
#include "geometry/parts/picture.h"
#include "geometry/parts/simplified.h"

namespace flexmorph {
namespace {

std::vector<Vec2> corners_of_box(double x0, double y0, double x1, double y1) {
  return corners_of({{x0, y0}, {x1, y1}});
}

const Region kSheet{corners_of_box(-10, -10, 10, 10), {}};

std::vector<Region> united(const std::vector<std::vector<Vec2>>& polygons) {
  return unite(polygons, kSheet, {});
}

/// Returns the largest rotation to the right of counterclockwise outlines within an arc of given
/// length [rad].
double sharpest(const std::vector<Vec2>& ring, double arc) {
  double worst = 0;
  const size_t n = ring.size();
  const auto turn = [&](size_t k) {
    const Vec2 a = ring[k] - ring[(k + n - 1) % n], b = ring[(k + 1) % n] - ring[k];
    return std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
  };
  for (size_t k = 0; k < n; ++k) {
    double length = 0, sum = 0;
    for (size_t m = k; length <= arc; ++m) {
      sum += turn(m % n);
      worst = std::min(worst, sum);
      length += (ring[(m + 1) % n] - ring[m % n]).norm();
    }
  }
  return -worst;
}

// A corner of 90 degrees is filled by r² (1 - π/4). All other vertices do not move.
TEST(Fillets, FillCorners) {
  const std::vector<Region> tee =
      united({corners_of_box(-3, 0, 3, 1), corners_of_box(-0.5, 1, 0.5, 4)});
  ASSERT_EQ(tee.size(), 1u);
  const double r = 0.8, filled = 2 * r * r * (1 - std::numbers::pi / 4);
  const std::vector<Region> found = with_fillets(tee, kSheet, {r, 0.9}, 1e-4);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(area(found), area(tee) + filled, 1e-3 * filled);
  for (const Vec2& corner : {Vec2(-3, 0), Vec2(3, 0), Vec2(3, 1), Vec2(0.5, 4), Vec2(-0.5, 4)})
    EXPECT_EQ(std::count(found[0].outer.begin(), found[0].outer.end(), corner), 1);
  EXPECT_LT(sharpest(found[0].outer, 0.25), 20 * std::numbers::pi / 180);
  EXPECT_GT(sharpest(tee[0].outer, 0.25), 1.5);
}

// Gaps narrower than the diameter are closed, wider ones remain; a thin wall across a gap becomes a
// bridge.
TEST(Fillets, CloseGapsAndThickenBlades) {
  const double r = 0.5;
  for (const double gap : {0.6, 1.4}) {
    const std::vector<Region> fork =
        united({corners_of_box(-3, 0, -2, 5), corners_of_box(-2, 0, 3, 1),
                corners_of_box(-2, 1 + gap, 3, 3 + gap)});
    const std::vector<Region> found = with_fillets(fork, kSheet, {r, 0.9}, 1e-4);
    const double added = area(found) - area(fork);
    if (gap < 2 * r)
      EXPECT_GT(added, 0.8 * 5 * gap);
    else
      EXPECT_NEAR(added, 3 * r * r * (1 - std::numbers::pi / 4), 0.01);
  }
  // For two discs at a distance of 0.82 the closing fills the gap with a wall of 0.024 in its
  // middle, which becomes a bridge.
  const std::vector<Vec2> left = circle_within({-1.41, 0}, 1, 1e-4),
                          right = circle_within({1.41, 0}, 1, 1e-4);
  const std::vector<Region> discs = united({left, right});
  const std::vector<Region> joined = with_fillets(discs, kSheet, {r, 0.9}, 1e-4);
  ASSERT_EQ(joined.size(), 1u);
  EXPECT_GT(smallest_features(joined, kSheet).solid, 0.9);
  EXPECT_LT(sharpest(joined[0].outer, 0.25 * r), 0.3);
  // At a distance of 0.92 the closing leaves the gap open.
  const std::vector<Vec2> far = circle_within({1.51, 0}, 1, 1e-4);
  const std::vector<Region> apart = with_fillets(united({left, far}), kSheet, {r, 0.9}, 1e-4);
  EXPECT_EQ(apart.size(), 2u);
}

// Without a radius nothing changes. Holes are preserved.
TEST(Fillets, KeepWhatTheyDoNotFill) {
  const std::vector<std::vector<Vec2>> outer = {corners_of_box(0, 0, 6, 4)},
                                       hole = {corners_of_box(2, 1, 4, 3)};
  const std::vector<Region> plate = unite(outer, kSheet, hole);
  ASSERT_EQ(plate.size(), 1u);
  const std::vector<Region> same = with_fillets(plate, kSheet, {0, 0.9}, 1e-4);
  EXPECT_EQ(same[0].outer, plate[0].outer);
  const std::vector<Region> found = with_fillets(plate, kSheet, {0.5, 0.9}, 1e-4);
  ASSERT_EQ(found.size(), 1u);
  ASSERT_EQ(found[0].holes.size(), 1u);
  EXPECT_NEAR(area(found), 20 + 4 * 0.25 * (1 - std::numbers::pi / 4), 1e-3);
  EXPECT_TRUE(with_fillets({}, kSheet, {1, 1}, 1e-3).empty());
}

// The material nearly reaches the corners of the domain, and no fragments may remain there: every
// connected region contains material of the given outline.
TEST(Fillets, LeaveNoFlecksAtCorners) {
  const Region domain{corners_of_box(0, -5, 53, 5), {}};
  for (int k = 0; k < 20; ++k) {
    const double top = 4.2 + 0.03 * k;
    const std::vector<Vec2> bar = {{0, -4}, {53, -4}, {53, 3}, {20, top + 0.2}, {0, top}};
    const std::vector<Region> given = unite({&bar, 1}, domain, {});
    EXPECT_EQ(with_fillets(given, domain, {1.6, 2}, 0.01).size(), 1u) << top;
  }
}

// A round end that exceeds the border by a tenth of the tolerance remains attached to the border
// along the chord that the border cuts off.
TEST(Fillets, StayAttachedToTheBorder) {
  const Region domain{corners_of_box(0, -10, 20, 10), {}};
  constexpr double kTolerance = 1e-2, kBeyond = 0.1 * kTolerance, kRadius = 2;
  const std::vector<std::vector<Vec2>> bar = {circle_within({kRadius - kBeyond, 0}, kRadius, 1e-4),
                                              corners_of_box(2, -2, 20, 2)};
  const std::vector<Region> given = unite(bar, domain, {});
  const std::vector<Region> found = with_fillets(given, domain, {1.6, 1.8}, kTolerance);
  ASSERT_EQ(found.size(), 1u);
  double low = 0, high = 0;
  for (const Vec2& p : found[0].outer)
    if (p.x() == 0) {
      low = std::min(low, p.y());
      high = std::max(high, p.y());
    }
  const double half = std::sqrt(2 * kRadius * kBeyond);
  EXPECT_NEAR(high, half, 0.1 * half);
  EXPECT_NEAR(low, -half, 0.1 * half);
}

// A circle keeps the sides that its tolerance needs, a corners_of_box keeps its corners.
TEST(Simplified, RingsKeepToTheTolerance) {
  const std::vector<Vec2> fine = circle_within({1, 2}, 6, 1e-4);
  const std::vector<Vec2> coarse = simplified(fine, 0.02);
  EXPECT_LT(coarse.size(), 0.2 * static_cast<double>(fine.size()));
  for (const Vec2& p : fine) {
    double near = 1;
    for (size_t k = 0; k < coarse.size(); ++k)
      near = std::min(near, distance({coarse[k], coarse[(k + 1) % coarse.size()]}, p));
    EXPECT_LE(near, 0.02);
  }
  std::vector<Vec2> corners = corners_of_box(0, 0, 2, 1);
  corners.insert(corners.begin() + 1, {1, 0});
  std::reverse(corners.begin(), corners.end());
  const std::vector<Vec2> kept = simplified(corners, 1e-3);
  EXPECT_EQ(kept.size(), 4u);
  EXPECT_EQ(std::count(kept.begin(), kept.end(), Vec2(1, 0)), 0);
}

// The sum over all cells is the area, a cell that the outline bisects is half full, and a hole is
// void.
TEST(Coverage, OfPolygonsIsExact) {
  Grid grid{.x0 = -1, .y0 = 0, .width = 6, .height = 4};
  grid.nx = 12;
  grid.ny = 8;
  const Region triangle{{{-1, 0}, {5, 0}, {5, 4}}, {}};
  const std::vector<Region> one = {triangle};
  const VectorXd f = area_fractions(grid, one);
  EXPECT_NEAR(f.sum() * grid.dx() * grid.dy(), 12, 1e-12);
  EXPECT_EQ(f[grid.cell(11, 0)], 1);
  EXPECT_EQ(f[grid.cell(0, 7)], 0);
  // The diagonal has a slope of 2/3; it covers a third of the first cell.
  EXPECT_NEAR(f[grid.cell(0, 0)], 1. / 3, 1e-12);
  Region holed{corners_of_box(-1, 0, 5, 4), {circle_within({2, 2}, 1.1, 1e-3)}};
  std::reverse(holed.holes[0].begin(), holed.holes[0].end());
  const std::vector<Region> two = {holed};
  const VectorXd g = area_fractions(grid, two);
  EXPECT_NEAR(g.sum() * grid.dx() * grid.dy(), area(two), 1e-12);
  EXPECT_EQ(g[grid.cell(6, 4)], 0);
  EXPECT_EQ(g[grid.cell(0, 0)], 1);
  EXPECT_GE(g.minCoeff(), 0);
}

// Fillets that are small relative to the width of fillings leave no thin strips along the border
// where a bar crosses it at an angle: the corners of the part there are the corners of the bar.
TEST(Fillets, LeaveNoWhiskersAlongTheBorder) {
  const Region sheet{corners_of_box(0, -5, 10, 5), {}};
  const std::vector<std::vector<Vec2>> bars = {{{-1, -0.8}, {4, -1}, {4, 1}, {-1, 0.8}},
                                               corners_of_box(4, -5, 5, 5)};
  const std::vector<Region> given = unite(bars, sheet, {});
  ASSERT_EQ(given.size(), 1u);
  const double r = 0.1, tolerance = 1e-3;
  const std::vector<Region> found = with_fillets(given, sheet, {r, 0.9}, tolerance);
  ASSERT_EQ(found.size(), 1u);
  std::vector<Vec2> on_border;
  for (const Vec2& v : found[0].outer)
    if (std::abs(v.x()) < tolerance) on_border.push_back(v);
  ASSERT_EQ(on_border.size(), 2u);
  for (const Vec2& v : on_border) EXPECT_NEAR(std::abs(v.y()), 0.84, tolerance);
  EXPECT_GT(smallest_features(found, sheet).solid, 0.99);
}

}  // namespace
}  // namespace flexmorph
