// Shows that the union of polygons is exact, that holes and connected regions are counted, and that
// the domain clips it.

#include "geometry/components/outline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/disc.h"
#include "geometry/parts/triangulate.h"
#include "tests/geometry/random_components.h"

namespace flexmorph {
namespace {

using Polygons = std::vector<std::vector<Vec2>>;

std::vector<Vec2> rectangle(double x0, double y0, double x1, double y1) {
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

const Box kLarge{{-100, -100}, {100, 100}};

TEST(Unite, CrossingRectanglesOverlapOnce) {
  const Polygons cross = {rectangle(-3, -1, 3, 1), rectangle(-1, -3, 1, 3)};
  const auto united = unite(cross, kLarge);
  ASSERT_EQ(united.size(), 1u);
  EXPECT_EQ(united[0].outer.size(), 12u);
  EXPECT_TRUE(united[0].holes.empty());
  EXPECT_EQ(area(united), 12 + 12 - 4);  // whole numbers: exact
}

TEST(Unite, TurnedRectangleOverlapsAsComputedByHand) {
  // A square of side 2 and its copy rotated by 45 degrees share a regular octagon of inradius 1:
  // area 8 (√2 - 1).
  std::vector<Vec2> turned;
  const double r = std::numbers::sqrt2;
  for (int k = 0; k < 4; ++k) {
    turned.emplace_back(r * std::cos(k * std::numbers::pi / 2),
                        r * std::sin(k * std::numbers::pi / 2));
  }
  const Polygons both = {rectangle(-1, -1, 1, 1), turned};
  EXPECT_NEAR(area(unite(both, kLarge)), 8 - 8 * (std::numbers::sqrt2 - 1), 1e-14);
}

TEST(Unite, FrameHasAHole) {
  const Polygons frame = {rectangle(0, 0, 4, 1), rectangle(0, 3, 4, 4), rectangle(0, 0, 1, 4),
                          rectangle(3, 0, 4, 4)};
  const auto united = unite(frame, kLarge);
  ASSERT_EQ(united.size(), 1u);
  ASSERT_EQ(united[0].holes.size(), 1u);
  EXPECT_EQ(area(united[0]), 16 - 4);
  EXPECT_TRUE(contains(united[0], {0.5, 2}));
  EXPECT_FALSE(contains(united[0], {2, 2}));    // in the hole
  EXPECT_TRUE(contains(united[0], {1, 2}));     // on the hole's edge
  EXPECT_TRUE(contains(united[0], {4, 4}));     // on a corner
  EXPECT_FALSE(contains(united[0], {4.1, 2}));  // outside
}

// The superellipse |x/L|^6 + |y/g|^6 <= 1 has the area 4 L g Γ(7/6)²/Γ(4/3). The area of a polygon
// within 1e-7 of a curve of length 5 has an error below 5e-7.
TEST(OutlineWithin, HasTheAreaOfItsSuperellipse) {
  const Component c{
      .center = {0.3, -0.2}, .half_length = 1, .angle = 0.4, .c1 = 0.25, .c2 = 0.25, .c3 = 0.25};
  const double exact = 4 * 0.25 * std::pow(std::tgamma(7.0 / 6), 2) / std::tgamma(4.0 / 3);
  const std::vector<std::vector<Vec2>> fine = {outline_within(c, 0.01, 1e-7)};
  EXPECT_NEAR(area(unite(fine, kLarge)), exact, 1e-6 * exact);
  const std::vector<Vec2> coarse = outline_within(c, 0.01, 1e-3);
  EXPECT_LT(coarse.size(), fine[0].size());
  EXPECT_NEAR(area(Region{coarse, {}}), exact, 5e-3);
  EXPECT_THROW(outline_within(c, 0.01, 0), Error);
}

TEST(Unite, ClipsToAPolygonAndTakesVoidsOut) {
  const std::vector<Vec2> L = {{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}};
  const std::vector<std::vector<Vec2>> all = {{{-5, -5}, {5, -5}, {5, 5}, {-5, 5}}};
  EXPECT_NEAR(area(unite(all, {L, {}}, {})), 5, 1e-15);
  const std::vector<std::vector<Vec2>> voids = {
      {{0.25, 0.25}, {0.75, 0.25}, {0.75, 0.75}, {0.25, 0.75}}};
  const std::vector<Region> with_hole = unite(all, {L, {}}, voids);
  ASSERT_EQ(with_hole.size(), 1u);
  EXPECT_EQ(with_hole[0].holes.size(), 1u);
  EXPECT_NEAR(area(with_hole), 4.75, 1e-15);
}

TEST(Unite, ClipsToTheBoxAndKeepsPiecesApart) {
  const Polygons bars = {rectangle(-5, 0, 5, 1), rectangle(-5, 2, 5, 3), rectangle(20, 20, 21, 21)};
  const auto united = unite(bars, {{0, 0.5}, {3, 2.5}});
  ASSERT_EQ(united.size(), 2u);
  EXPECT_EQ(area(united), 3 * 0.5 + 3 * 0.5);
  EXPECT_TRUE(unite(bars, {{6, 6}, {7, 7}}).empty());
  EXPECT_TRUE(unite(Polygons{}, kLarge).empty());
}

TEST(Unite, CoincidentAndTouchingPolygonsAreNoTrouble) {
  const Polygons same = {rectangle(0, 0, 1, 1), rectangle(0, 0, 1, 1), rectangle(1, 0, 2, 1)};
  const auto united = unite(same, kLarge);
  ASSERT_EQ(united.size(), 1u);
  EXPECT_EQ(area(united), 2);
}

TEST(Unite, SenseOfRotationDoesNotMatter) {
  std::vector<Vec2> clockwise = rectangle(0, 0, 2, 1);
  std::reverse(clockwise.begin(), clockwise.end());
  EXPECT_EQ(area(unite(Polygons{clockwise}, kLarge)), 2);
}

TEST(Unite, RefusesWhatIsNoPolygon) {
  const double nan = std::nan("");
  EXPECT_THROW(unite(Polygons{{{0, 0}, {1, 1}, {1, 0}, {0, 1}}}, kLarge), Error);  // bow tie
  EXPECT_THROW(unite(Polygons{{{0, 0}, {1, 1}}}, kLarge), Error);
  EXPECT_THROW(unite(Polygons{{{0, 0}, {1, nan}, {1, 0}}}, kLarge), Error);
  EXPECT_THROW(unite(Polygons{rectangle(0, 0, 1, 1)}, {{1, 1}, {1, 2}}), Error);
}

// The unions in two half planes add up to the whole: clipping neither loses nor duplicates area.
TEST(Unite, HalvesOfComponentUnionsAddUp) {
  test::RandomComponents random(4);
  for (int k = 0; k < 5; ++k) {
    Polygons outlines;
    double sum = 0;
    for (const Component& c : random.several(6, 1, 1)) {
      outlines.push_back(outline(c, 0.01, 48));
      sum += area(unite(Polygons{outlines.back()}, kLarge));
    }
    const double all = area(unite(outlines, kLarge));
    const double left = area(unite(outlines, {{-100, -100}, {0.5, 100}}));
    const double right = area(unite(outlines, {{0.5, -100}, {100, 100}}));
    EXPECT_NEAR(left + right, all, 1e-13);
    EXPECT_LE(all, sum * (1 + 1e-12));
  }
}

double area_of(const Triangulation& t) {
  double out = 0;
  for (const auto& [a, b, c] : t.triangles) {
    const Vec2 ab = t.points.at(static_cast<size_t>(b)) - t.points.at(static_cast<size_t>(a));
    const Vec2 ac = t.points.at(static_cast<size_t>(c)) - t.points.at(static_cast<size_t>(a));
    out += 0.5 * (ab.x() * ac.y() - ab.y() * ac.x());
  }
  return out;
}

// Exact outlines are rounded to doubles; then points coincide, and edges cross by round-off. Areas
// must not change.
TEST(Triangulate, BearsWhatRoundingDoesToOutlines) {
  const std::vector<Vec2> square = {{0, 0}, {1, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 1}};
  EXPECT_NEAR(area_of(triangulate({square, {}})), 1, 1e-15);
  // protrudes through the edge
  const std::vector<Vec2> hole = {{0.4, -1e-18}, {0.2, 0.5}, {0.6, 0.5}};
  EXPECT_NEAR(area_of(triangulate({square, {hole}})), 0.9, 1e-15);
}

// Diamonds touch at their corners: 900 holes, and between them as many regions of material that
// share single points only. The remaining area is known.
TEST(Triangulate, KnowsInsideFromOutsideWhereRingsTouch) {
  constexpr int kSide = 30;
  Region sieve{rectangle(0, 0, kSide, kSide), {}};
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j)
      sieve.holes.push_back({{i + 0.5, j}, {i, j + 0.5}, {i + 0.5, j + 1}, {i + 1, j + 0.5}});
  EXPECT_NEAR(area_of(triangulate(sieve)), 0.5 * kSide * kSide, 1e-12 * kSide * kSide);
}

// A polygon of n sides inscribed in a circle has the area n/2 r² sin(2π/n); its sides are r (1 -
// cos(π/n)) inside.
TEST(Circle, SidesStayWithinTheTolerance) {
  for (const double r : {1e-3, 0.7, 40.0})
    for (const double tolerance : {1e-6, 1e-3, 10.0}) {
      const std::vector<Vec2> ring = circle_within({0.3, -2}, r, tolerance);
      const auto n = static_cast<double>(ring.size());
      EXPECT_LE(r * (1 - std::cos(std::numbers::pi / n)), tolerance * (1 + 1e-9));
      const double fewer = r * (1 - std::cos(std::numbers::pi / (n - 1)));
      EXPECT_TRUE(n == 8 || fewer > tolerance * (1 - 1e-6));
      const double exact = 0.5 * n * r * r * std::sin(2 * std::numbers::pi / n);
      EXPECT_NEAR(area({ring, {}}), exact, 1e-10 * exact);
    }
  EXPECT_THROW(circle_within({0, 0}, 0, 1), Error);
  EXPECT_THROW(circle_within({0, 0}, 1, NAN), Error);
}

// A regular polygon of n corners on a circle of radius r has the area n r^2 sin(2 pi / n) / 2.
TEST(Disc, HasTheAreaAndTheCentroidOfAPolygon) {
  const Vec2 center(300, -2);
  for (const int n : {3, 8, 200}) {
    std::vector<Vec2> ring;
    for (int k = 0; k < n; ++k) {
      const double angle = -2 * std::numbers::pi * k / n;  // clockwise, like holes
      ring.emplace_back(center + 0.7 * Vec2(std::cos(angle), std::sin(angle)));
    }
    const Disc found = disc_like(ring);
    EXPECT_NEAR((found.center - center).norm(), 0, 1e-12);
    const double area = 0.5 * n * 0.7 * 0.7 * std::sin(2 * std::numbers::pi / n);
    EXPECT_NEAR(found.radius, std::sqrt(area / std::numbers::pi), 1e-12);
  }
  // The centroid of a triangle is the mean of its corners.
  const Disc triangle = disc_like({{1, 1}, {4, 1}, {1, 7}});
  EXPECT_NEAR((triangle.center - Vec2(2, 3)).norm(), 0, 1e-14);
}

TEST(Disc, MatchesARoundPolygonOnly) {
  const std::vector<Vec2> round = circle_within({1, 2}, 3, 1e-4);
  EXPECT_TRUE(matches(round, {{1, 2}, 3}, 1e-3));
  EXPECT_TRUE(matches(round, {{1.04, 2}, 3.04}, 0.05));
  EXPECT_FALSE(matches(round, {{1.06, 2}, 3}, 0.05));
  EXPECT_FALSE(matches(round, {{1, 2}, 2.94}, 0.05));
  const double half = 0.5 * std::sqrt(std::numbers::pi) * 3;  // a square of the same area
  const std::vector<Vec2> square = {
      {1 - half, 2 - half}, {1 + half, 2 - half}, {1 + half, 2 + half}, {1 - half, 2 + half}};
  EXPECT_FALSE(matches(square, {{1, 2}, 3}, 0.05));
}

}  // namespace
}  // namespace flexmorph
