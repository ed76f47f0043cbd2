// Shows that the curves of polygons have exact areas, radii and distances, and that mirrored
// polygons have mirrored curves.
#include "geometry/parts/outline_curves.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace flexmorph {
namespace {

constexpr double kTolerance = 3e-5;
using Ring = std::vector<Vec2>;

std::vector<CurveRing> rings_of(const CurvedRegion& region) {
  std::vector<CurveRing> out = {region.outer};
  out.insert(out.end(), region.holes.begin(), region.holes.end());
  return out;
}

double distance(const Vec2& a, const Vec2& b, const Vec2& p) {
  const Vec2 side = b - a;
  return (p - a - std::clamp((p - a).dot(side) / side.squaredNorm(), 0.0, 1.0) * side).norm();
}
double distance(const Ring& ring, const Vec2& p) {
  double least = INFINITY;
  for (std::size_t k = 0; k < ring.size(); ++k)
    least = std::min(least, distance(ring[k], ring[(k + 1) % ring.size()], p));
  return least;
}

/// Returns the largest distance from vertices of one ring to the other ring.
double farthest(const Ring& from, const Ring& to) {
  double out = 0;
  for (const Vec2& p : from) out = std::max(out, distance(to, p));
  return out;
}
double hausdorff(const Ring& a, const Ring& b) { return std::max(farthest(a, b), farthest(b, a)); }

void expect_closed(const CurvedRegion& region) {
  for (const CurveRing& ring : rings_of(region))
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const OutlineCurve &c = ring[k], &next = ring[(k + 1) % ring.size()];
      EXPECT_EQ(c.to.x(), next.from.x());
      EXPECT_EQ(c.to.y(), next.from.y());
      if (c.is_line()) continue;
      // CAD kernels treat 1e-10 m as zero distance.
      EXPECT_NEAR((c.from - c.center).norm(), c.radius, 1e-10);
      EXPECT_NEAR((c.to - c.center).norm(), c.radius, 1e-10);
      EXPECT_NEAR((c.at(1 - 1e-9) - c.to).norm(), 0, 1e-8 * c.radius);
    }
}

int lines_in(const CurveRing& ring) {
  return static_cast<int>(
      std::count_if(ring.begin(), ring.end(), [](const auto& c) { return c.is_line(); }));
}

/// Returns a bar whose sides are convex or concave.
Component curved_bar(const Vec2& center, double angle, double end, double middle) {
  return {
      .center = center, .half_length = 0.04, .angle = angle, .c1 = end, .c2 = end, .c3 = middle};
}

/// Returns a link of two bars and two eyes with bores that a side of the domain cuts.
std::vector<Region> link(double mirror = 1) {
  std::vector<Ring> all;
  for (const Component& c : {curved_bar({0.05, mirror * 0.004}, mirror * 0.2, 0.003, 0.005),
                             curved_bar({0.05, mirror * -0.003}, mirror * -0.25, 0.004, 0.003)})
    all.push_back(outline_within(c, 1e-3, 0.5 * kTolerance));
  std::vector<Ring> bores;
  for (const double x : {0.012, 0.088}) {
    all.push_back(circle_within({x, 0}, 0.01, 0.5 * kTolerance));
    bores.push_back(circle_within({x, 0}, 0.004, 0.5 * kTolerance));
  }
  return unite(all, {corners_of({{0.004, -0.02}, {0.1, 0.02}}), {}}, bores);
}

TEST(OutlineCurves, OfADiscIsACircleOfItsRadius) {
  for (const double tolerance : {1e-3, 1e-5, 1e-7}) {
    const Vec2 center(0.14, 0.022);
    const Ring hole = circle_within(center, 0.008, tolerance);
    const Region plate{corners_of({{0, 0}, {0.3, 0.1}}), {Ring(hole.rbegin(), hole.rend())}};
    const CurvedRegion out = curves_of({&plate, 1}, tolerance)[0];
    ASSERT_EQ(out.holes.size(), 1u);
    ASSERT_EQ(out.holes[0].size(), 1u);
    EXPECT_TRUE(out.holes[0][0].is_circle());
    EXPECT_NEAR(out.holes[0][0].radius, 0.008, 1e-13);
    EXPECT_NEAR((out.holes[0][0].center - center).norm(), 0, 1e-13);
    EXPECT_EQ(lines_in(out.outer), 4);
    EXPECT_EQ(out.outer.size(), 4u);
    EXPECT_NEAR(area(out), 0.03 - std::numbers::pi * 0.008 * 0.008, 1e-15);
  }
}

// A rounded rectangle must become lines and quarter circles with the exact area.
TEST(OutlineCurves, OfARoundedRectangleAreFourLinesAndFourArcs) {
  const double w = 0.12, h = 0.05, r = 0.007;
  Ring ring;
  const Vec2 centers[] = {{w - r, r}, {w - r, h - r}, {r, h - r}, {r, r}};
  for (int corner = 0; corner < 4; ++corner)
    for (int k = 0; k <= 16; ++k) {
      const double angle = (corner - 1) * std::numbers::pi / 2 + k * std::numbers::pi / 32;
      ring.push_back(centers[corner] + r * Vec2(std::cos(angle), std::sin(angle)));
    }
  for (std::size_t first = 0; first < ring.size(); first += 5) {
    std::rotate(ring.begin(), ring.begin() + 5, ring.end());
    const Region plate{ring, {}};
    const CurvedRegion out = curves_of({&plate, 1}, kTolerance)[0];
    EXPECT_EQ(out.outer.size(), 8u);
    EXPECT_EQ(lines_in(out.outer), 4);
    EXPECT_NEAR(area(out), w * h - (4 - std::numbers::pi) * r * r, 1e-14);
    for (const OutlineCurve& c : out.outer)
      if (!c.is_line()) {
        EXPECT_NEAR(c.radius, r, 1e-12);
        EXPECT_NEAR(c.sweep, std::numbers::pi / 2, 1e-9);
      }
    expect_closed(out);
  }
}

// A vertex that is 3e-9 m off a circle of 4 m is on it to round-off. The arc must end at the
// vertex.
TEST(OutlineCurves, OfALargeCircleEndAtItsVertices) {
  const double r = 4;
  Ring ring = {{0.1, -0.1}};
  for (int k = 0; k <= 20; ++k) {
    const double angle = 0.5 * std::numbers::pi + 0.002 * k, off = k == 20 ? 3e-9 : 0;
    ring.push_back(Vec2(0.1, -r) + (r + off) * Vec2(std::cos(angle), std::sin(angle)));
  }
  ring.push_back({ring.back().x(), -0.1});
  const std::vector<CurvedRegion> found = curves_of(std::vector<Region>{{ring, {}}}, kTolerance);
  ASSERT_EQ(found.size(), 1u);
  expect_closed(found[0]);
  EXPECT_EQ(found[0].outer.size(), 4u);
  EXPECT_EQ(lines_in(found[0].outer), 3);
}

// Six vertices on a circle are no circle if their sides are far inside it.
TEST(OutlineCurves, OfAHexagonAreItsSides) {
  Ring ring;
  for (int k = 0; k < 6; ++k)
    ring.push_back(0.01 *
                   Vec2(std::cos(k * std::numbers::pi / 3), std::sin(k * std::numbers::pi / 3)));
  const Region plate{ring, {}};
  const CurvedRegion out = curves_of({&plate, 1}, kTolerance)[0];
  EXPECT_EQ(out.outer.size(), 6u);
  EXPECT_EQ(lines_in(out.outer), 6);
}

// Where a line cuts a disc, arc and line meet: the expected area is that of a circular segment.
TEST(OutlineCurves, MeetWhereAnArcIsCut) {
  for (const double height : {0.0031, 0.0, -0.0047}) {
    const Ring disc = circle_within({0, 0}, 0.01, kTolerance);
    const std::vector<Region> cut = unite({&disc, 1}, {{-1, -1}, {1, height}});
    const CurvedRegion out = curves_of(cut, kTolerance)[0];
    ASSERT_EQ(out.outer.size(), 2u);
    EXPECT_EQ(lines_in(out.outer), 1);
    const double half = std::acos(height / 0.01);
    EXPECT_NEAR(area(out), 1e-4 * (std::numbers::pi - half + 0.5 * std::sin(2 * half)), 1e-14);
    for (const OutlineCurve& c : out.outer) EXPECT_NEAR(c.from.y(), height, 1e-15);
  }
  const std::vector<Ring> two = {circle_within({0, 0}, 0.01, kTolerance),
                                 circle_within({0.013, 0.002}, 0.008, kTolerance)};
  const std::vector<Region> lens = unite(two, {{-1, -1}, {1, 1}});
  const CurvedRegion out = curves_of(lens, kTolerance)[0];
  ASSERT_EQ(out.outer.size(), 2u);
  const double d = std::hypot(0.013, 0.002), a = (d * d + 1e-4 - 6.4e-5) / (2 * d), b = d - a;
  const double alpha = std::acos(a / 0.01), beta = std::acos(b / 0.008);
  EXPECT_NEAR(area(out),
              std::numbers::pi * (1e-4 + 6.4e-5) - 1e-4 * (alpha - 0.5 * std::sin(2 * alpha)) -
                  6.4e-5 * (beta - 0.5 * std::sin(2 * beta)),
              1e-14);
}

// Curves stay within the tolerance of their polygon and of a finer one, and their number is less
// than half of the sides.
TEST(OutlineCurves, OfComponentsStayWithinTheTolerance) {
  const Component c = curved_bar({0, 0}, 0.3, 0.004, 0.006);
  const Region coarse{outline_within(c, 1e-3, 0.5 * kTolerance), {}};
  const CurvedRegion out = curves_of({&coarse, 1}, kTolerance)[0];
  expect_closed(out);
  const Ring sampled = polygon_within(out.outer, 1e-3 * kTolerance);
  EXPECT_LT(hausdorff(sampled, coarse.outer), 0.5 * kTolerance);
  EXPECT_LT(farthest(sampled, outline_within(c, 1e-3, 1e-3 * kTolerance)), kTolerance);
  EXPECT_LT(out.outer.size(), coarse.outer.size() / 2);
  EXPECT_NEAR(area(out), area(Region{sampled, {}}), 1e-3 * kTolerance * 0.2);
  // Consecutive curves have the same tangent direction.
  for (std::size_t k = 0; k < out.outer.size(); ++k) {
    const OutlineCurve &a = out.outer[k], &b = out.outer[(k + 1) % out.outer.size()];
    const Vec2 s = (a.to - a.at(1 - 1e-6)).normalized(), t = (b.at(1e-6) - b.from).normalized();
    EXPECT_GT(s.dot(t), std::cos(0.02));
  }
}

TEST(OutlineCurves, OfALinkHaveItsBoresAndItsArea) {
  const std::vector<Region> regions = link();
  ASSERT_EQ(regions.size(), 1u);
  const CurvedRegion out = curves_of(regions, kTolerance)[0];
  expect_closed(out);
  int bores = 0, eyes = 0;
  double perimeter = 0;
  for (const CurveRing& ring : rings_of(out))
    for (const OutlineCurve& c : ring) {
      perimeter += c.is_line() ? (c.to - c.from).norm() : c.radius * std::abs(c.sweep);
      if (c.is_circle()) {
        ++bores;
        EXPECT_NEAR(c.radius, 0.004, 1e-13);
      }
      eyes += !c.is_line() && std::abs(c.radius - 0.01) < 1e-12 && std::abs(c.center.y()) < 1e-12;
    }
  EXPECT_EQ(bores, 2);
  EXPECT_GE(eyes, 3);
  EXPECT_NEAR(area(out), area(regions[0]), perimeter * kTolerance);
  std::size_t vertices = 0, curves = 0;
  for (const CurveRing& ring : rings_of(out)) curves += ring.size();
  for (const Ring& ring : flexmorph::rings_of(regions[0])) vertices += ring.size();
  EXPECT_LT(3 * curves, vertices);
}

// A mirrored design has mirrored curves within the tolerance.
TEST(OutlineCurves, OfAMirroredLinkAreMirrored) {
  const CurvedRegion one = curves_of(link(), kTolerance)[0],
                     two = curves_of(link(-1), kTolerance)[0];
  ASSERT_EQ(one.holes.size(), two.holes.size());
  Ring a = polygon_within(one.outer, 0.01 * kTolerance),
       b = polygon_within(two.outer, 0.01 * kTolerance);
  for (Vec2& p : b) p.y() = -p.y();
  EXPECT_LT(hausdorff(a, b), kTolerance);
}

// A drop has one corner. Its curves must be closed and stay within half of the tolerance of the
// polygon for any first vertex.
TEST(OutlineCurves, OfADropKeepItsCorner) {
  Ring ring;
  constexpr int kVertices = 400;
  for (int k = 0; k < kVertices; ++k) {
    const double t = 2 * std::numbers::pi * k / kVertices;
    ring.emplace_back(-0.02 * std::cos(t),
                      0.01 * std::sin(t) * (1 - 0.4 * std::cos(t)) * std::sin(0.5 * t));
  }
  for (const std::size_t first : {0, 7}) {
    Ring turned = ring;
    std::rotate(turned.begin(), turned.begin() + static_cast<std::ptrdiff_t>(first), turned.end());
    std::reverse(turned.begin(), turned.end());  // counterclockwise
    const Region drop{turned, {}};
    ASSERT_GT(area(drop), 0);
    const CurvedRegion out = curves_of({&drop, 1}, kTolerance)[0];
    expect_closed(out);
    EXPECT_LT(hausdorff(polygon_within(out.outer, 1e-3 * kTolerance), ring), 0.5 * kTolerance);
    EXPECT_LT(out.outer.size(), 60u);
  }
}

// Vertices on a side of the domain do not divide its line, even where an edge leaves it at a small
// angle.
TEST(OutlineCurves, OfSidesWithVerticesOnThemAreOneLine) {
  Ring ring = {{0, 0}, {0.01, 0}, {0.0103, 0}, {0.02, 0}, {0.03, 0.0008}, {0.03, 0.02}, {0, 0.02}};
  for (std::size_t k = 0; k < ring.size(); ++k) {
    std::rotate(ring.begin(), ring.begin() + 1, ring.end());
    const Region plate{ring, {}};
    const CurvedRegion out = curves_of({&plate, 1}, kTolerance)[0];
    EXPECT_EQ(out.outer.size(), 5u);
    EXPECT_EQ(lines_in(out.outer), 5);
    EXPECT_NEAR(area(out), area(plate), 1e-16);
  }
}

// Slits far below the tolerance remain open, and curves do not cross.
TEST(OutlineCurves, DoNotCrossInSlits) {
  std::vector<Ring> two;
  const Component c = curved_bar({0.05, 0}, 0, 0.003, 0.003);
  for (const double y : {0.0, 0.00600001}) {
    Component moved = c;
    moved.center.y() = y;
    two.push_back(outline_within(moved, 1e-3, 0.5 * kTolerance));
  }
  two.push_back(corners_of({{0.01, -0.001}, {0.02, 0.007}}));
  two.push_back(corners_of({{0.08, -0.001}, {0.09, 0.007}}));
  const std::vector<Region> regions = unite(two, {{-1, -1}, {1, 1}});
  ASSERT_EQ(regions.size(), 1u);
  ASSERT_EQ(regions[0].holes.size(), 1u);
  const CurvedRegion out = curves_of(regions, kTolerance)[0];
  std::vector<Ring> rings;
  for (const CurveRing& ring : rings_of(out)) rings.push_back(polygon_within(ring, 1e-8));
  EXPECT_NO_THROW(region_of(rings));
}

// In an outline that touches itself, bores are nevertheless circles.
TEST(OutlineCurves, OfOutlinesThatTouchThemselvesHaveBores) {
  const Ring plate = corners_of({{0, 0}, {0.1, 0.05}});
  const std::vector<Ring> voids = {corners_of({{0.01, 0.01}, {0.02, 0.02}}),
                                   corners_of({{0.02, 0.02}, {0.03, 0.03}}),
                                   circle_within({0.07, 0.02}, 0.01, kTolerance)};
  const std::vector<Region> regions = unite({&plate, 1}, {plate, {}}, voids);
  const std::vector<CurvedRegion> out = curves_of(regions, kTolerance);
  ASSERT_EQ(out.size(), 1u);
  EXPECT_NEAR(area(out), 0.005 - 2e-4 - std::numbers::pi * 1e-4, 1e-14);
}

TEST(OutlineCurves, RefusesABadTolerance) {
  EXPECT_THROW(curves_of({}, 0), Error);
  EXPECT_THROW(curves_of({}, NAN), Error);
}

}  // namespace
}  // namespace flexmorph
