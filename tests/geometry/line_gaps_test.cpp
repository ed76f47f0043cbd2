// Shows that gaps between material and a line are found for constructed shapes, and that gaps of
// random polygons are the distances of their nearest vertices.

#include "geometry/parts/line_gaps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "tests/geometry/random_components.h"

namespace flexmorph {
namespace {

constexpr double kLimit = 0.5;
const Segment kLine{{0, -1}, {0, 1}};
const Region kRectangle{{{0, -1}, {4, -1}, {4, 1}, {0, 1}}, {}};

std::vector<LengthScaleViolation> gaps(const std::vector<std::vector<Vec2>>& polygons) {
  const Segment lines[] = {kLine};
  return line_gaps(unite(polygons, kRectangle, {}), lines, kLimit);
}

TEST(LineGaps, OfCornersAndSidesAreTheirDistances) {
  // The shapes are a side parallel to the line, one corner, a shape that touches the line and one
  // far from it.
  const auto found = gaps({{{0.1, -0.9}, {1, -0.9}, {1, -0.7}, {0.1, -0.7}},
                           {{0.02, 0.1}, {1, 0}, {1, 0.2}},
                           {{-0.1, 0.4}, {1, 0.4}, {1, 0.5}, {-0.1, 0.5}},
                           {{0.6, 0.7}, {1, 0.7}, {1, 0.9}}});
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NEAR(found[0].width, 0.02, 1e-15);
  EXPECT_NEAR((found[0].b - Vec2(0.02, 0.1)).norm(), 0, 1e-15);
  EXPECT_NEAR((found[0].a - Vec2(0, 0.1)).norm(), 0, 1e-15);
  EXPECT_NEAR(found[1].width, 0.1, 1e-15);
  EXPECT_NEAR((found[1].b - Vec2(0.1, -0.8)).norm(), 0, 1e-15);
  for (const LengthScaleViolation& p : found) EXPECT_FALSE(p.solid);
}

TEST(LineGaps, AreNotSeenThroughMaterial) {
  // A wall at 0.1 covers the shape behind it; the hole in a block that touches the line is no gap.
  EXPECT_EQ(
      gaps({{{0.1, -0.5}, {0.2, -0.5}, {0.2, 0.5}, {0.1, 0.5}}, {{0.3, 0}, {1, -0.1}, {1, 0.1}}})
          .size(),
      1u);
  const Region frame{kRectangle.outer, {{{0.1, -0.3}, {0.1, 0.3}, {0.7, 0.3}, {0.7, -0.3}}}};
  const Segment lines[] = {kLine};
  EXPECT_TRUE(line_gaps({&frame, 1}, lines, kLimit).empty());
}

TEST(LineGaps, EndWhereTheLineEnds) {
  const Segment lines[] = {{{0, -1}, {0, 0.05}}};
  const std::vector<std::vector<Vec2>> above = {{{0.1, 0.2}, {1, 0.1}, {1, 0.3}}};
  EXPECT_EQ(gaps(above).size(), 1u);
  EXPECT_TRUE(line_gaps(unite(above, kRectangle, {}), lines, kLimit).empty());
}

// Of an outline and a line of the frame of the domain, the vertex of the outline with the smallest
// distance from the line must be found; vertices on the line have no gap.
TEST(LineGaps, OfRandomDesignsHaveTheNearestVertex) {
  int with_gap = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    std::vector<std::vector<Vec2>> outlines;
    for (const Component& c : test::RandomComponents(seed).several(6, 1, 1))
      outlines.push_back(outline_within(c, 0.01, 1e-3));
    const Region box{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {}};
    const Segment line[] = {{{0, 0}, {0, 1}}};
    for (const Region& piece : unite(outlines, box, {})) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const Vec2& p : piece.outer) nearest = std::min(nearest, p.x());
      const auto found = line_gaps({&piece, 1}, line, 2);
      if (nearest > 1e-9) {
        ASSERT_FALSE(found.empty());
        EXPECT_NEAR(found.front().width, nearest, 1e-12);
        ++with_gap;
      }
      for (const LengthScaleViolation& p : found) {
        EXPECT_NEAR(p.a.x(), 0, 0);
        EXPECT_FALSE(contains(piece, p.center));
      }
    }
  }
  EXPECT_GE(with_gap, 10);
}

}  // namespace
}  // namespace flexmorph
