// Shows that the low-pass filter of outlines has the right response to waves and keeps given
// points, the area, straight lines, fillets and symmetry, and that rings do not cross.
#include "geometry/parts/smoothing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace flexmorph {
namespace {

constexpr double kSmoothing = 1e-3;

std::vector<Vec2> box_with(double x0, double y0, double x1, double y1) {
  return corners_of({{x0, y0}, {x1, y1}});
}

/// Returns a plate of length 40 whose upper side, at 4, is a wave.
Region waved(double length, double height) {
  std::vector<Vec2> ring = {{0, 0}, {40, 0}, {40, 4}};
  constexpr int kSides = 1600;
  for (int k = kSides - 1; k > 0; --k) {
    const double x = 40.0 * k / kSides;
    ring.emplace_back(x, 4 + height * std::sin(2 * std::numbers::pi * x / length));
  }
  ring.emplace_back(0, 4);
  return {ring, {}};
}

const std::vector<std::vector<Vec2>> kStrip = {box_with(0, 0, 40, 10)};

Region smooth(const Region& region) {
  const std::vector<Region> out = smoothed({&region, 1}, kStrip, {}, {}, 1, kSmoothing);
  EXPECT_EQ(out.size(), 1u);
  return out.front();
}

/// Returns the largest height of the upper side above 4 far from its ends.
double height_of(const Region& region) {
  double out = 0;
  for (const Vec2& p : region.outer)
    if (p.x() > 12 && p.x() < 28) out = std::max(out, std::abs(p.y() - 4));
  return out;
}

// A wave of length l keeps 1 / (1 + (5 / l)^4) of its height for features of width 1.
TEST(Smoothing, HalvesWavesOfFiveFeatures) {
  for (const double length : {2.0, 4.0, 5.0, 8.0}) {
    const double height = 0.02 * length, response = 1 / (1 + std::pow(5 / length, 4));
    const double found = height_of(smooth(waved(length, height)));
    // No point moves by more than 0.12.
    const double expected = std::max(response * height, height - 0.12);
    EXPECT_NEAR(found, expected, 0.02 * height + 2 * kSmoothing) << length;
  }
}

// No point moves by more than 0.12 times the feature width.
TEST(Smoothing, MovesNothingFar) {
  EXPECT_GT(height_of(smooth(waved(2, 0.3))), 0.3 - 0.12 - kSmoothing);
}

// Points within one feature width of kept points do not move; beyond two widths they move without
// restriction.
TEST(Smoothing, KeepsLocations) {
  const Region plate = waved(4, 0.06);
  const Vec2 kept(20, 4);
  const Region all = smooth(plate),
               found = smoothed({&plate, 1}, kStrip, {}, {&kept, 1}, 1, kSmoothing).front();
  const auto height = [](const Region& of, double from, double to) {
    double out = 0;
    for (const Vec2& p : of.outer)
      if (p.x() > from && p.x() < to && p.y() > 1) out = std::max(out, std::abs(p.y() - 4));
    return out;
  };
  EXPECT_NEAR(height(found, 19, 21), height(plate, 19, 21), kSmoothing);
  EXPECT_NEAR(height(found, 23, 27), height(all, 23, 27), kSmoothing);
}

// A whole number of waves has no area, before and after.
TEST(Smoothing, KeepsTheArea) { EXPECT_NEAR(area(smooth(waved(4, 0.06))), 160, 1e-4 * 160); }

// Vertices on the domain and straight lines do not change by a bit; nor does any region with
// feature width zero.
TEST(Smoothing, LeavesLinesAlone) {
  const Region plate{{{0, 0}, {40, 0}, {40, 3}, {20, 6}, {0, 3}}, {}};
  const std::vector<Region> same = smoothed({&plate, 1}, kStrip, {}, {}, 0, kSmoothing);
  EXPECT_EQ(same.front().outer, plate.outer);
  const Region found = smooth(plate);
  for (const Vec2& corner : {plate.outer[0], plate.outer[1], plate.outer[2], plate.outer[4]})
    EXPECT_EQ(std::count(found.outer.begin(), found.outer.end(), corner), 1);
  // The ridge of 17 degrees is rounded.
  const auto top = std::max_element(found.outer.begin(), found.outer.end(),
                                    [](const Vec2& a, const Vec2& b) { return a.y() < b.y(); });
  EXPECT_LT(top->y(), 6 - 0.02);
  EXPECT_GT(top->y(), 6 - 0.12 - kSmoothing);
}

// A hole with the radius of a fillet, 0.8 features, keeps its shape and size to 2 %.
TEST(Smoothing, KeepsFillets) {
  const Vec2 center(20, 5);
  std::vector<Vec2> hole = circle_within(center, 0.8, 1e-4);
  std::reverse(hole.begin(), hole.end());
  const Region found = smooth({kStrip[0], {hole}});
  ASSERT_EQ(found.holes.size(), 1u);
  for (const Vec2& p : found.holes[0]) EXPECT_NEAR((p - center).norm(), 0.8, 0.02 * 0.8);
}

// A hole that is symmetric about a line remains symmetric to round-off.
TEST(Smoothing, IsSymmetricAboutMirrors) {
  std::vector<Vec2> hole;
  for (const auto& [x, y] :
       {std::pair(12.0, 0.0), {20.0, 2.0}, {24.0, 1.4}, {30.0, 1.5}, {33.0, 0.0}})
    hole.emplace_back(x, 5 + y);
  for (size_t k = hole.size() - 2; k > 0; --k) hole.emplace_back(hole[k].x(), 10 - hole[k].y());
  const Region plate{kStrip[0], {hole}};
  const Segment line{{0, 5}, {40, 5}};
  const std::vector<Region> out = smoothed({&plate, 1}, kStrip, {&line, 1}, {}, 1, 1e-6);
  for (const Vec2& p : out[0].holes[0]) {
    double near = 1;
    for (const Vec2& q : out[0].holes[0])
      near = std::min(near, (Vec2(q.x(), 10 - q.y()) - p).norm());
    EXPECT_LT(near, 1e-9);
  }
}

// If rings would cross, the region does not change: two holes, one of them fixed, have a wavy wall
// of 0.01 between them.
TEST(Smoothing, CrossesNothing) {
  std::vector<Vec2> left = {{5, 2}}, right = {{35, 2}};
  for (int k = 0; k <= 400; ++k) {
    const double y = 2 + 0.015 * k, wave = 0.1 * std::sin(2 * std::numbers::pi * y / 1.5);
    right.emplace_back(20.005 + wave, y);
    left.emplace_back(19.995 + wave, y);
  }
  right.emplace_back(35, 8);
  left.emplace_back(5, 8);
  std::reverse(left.begin(), left.end());
  const Region plate{kStrip[0], {right, left}};
  const std::vector<std::vector<Vec2>> fixed = {kStrip[0], left};
  const auto found = [&](bool check) {
    return smoothed({&plate, 1}, fixed, {}, {}, 1, kSmoothing, check).front();
  };
  EXPECT_THROW(region_of(rings_of(found(false))), Error);
  EXPECT_EQ(rings_of(found(true)), rings_of(plate));
}

}  // namespace
}  // namespace flexmorph
