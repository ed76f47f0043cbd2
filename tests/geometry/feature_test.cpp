// Shows that violations of the minimum length scale are found in shapes with known widths; that
// every reported disc is inscribed; that no opposite pair of sampled points is closer than the
// result; and that repeated runs agree bit for bit.

#include "geometry/parts/feature.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "tests/geometry/random_components.h"
#include "tests/geometry/scrambled_heap.h"

namespace flexmorph {
namespace {

using Polygon = std::vector<Vec2>;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Polygon box(double x0, double y0, double x1, double y1) {
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}
const Polygon kDomain = box(-5, -5, 5, 5);

Polygon circle(const Vec2& center, double radius, int n, double from = 0,
               double to = 2 * std::numbers::pi) {
  Polygon out;
  const bool closed = to - from > 2 * std::numbers::pi - 1e-9;
  for (int k = 0; k < n; ++k) {
    const double a = from + (to - from) * k / (closed ? n : n - 1);
    out.push_back(center + radius * Vec2(std::cos(a), std::sin(a)));
  }
  return out;
}

Polygon turned(Polygon p, double angle, double scale = 1, const Vec2& shift = {0, 0}) {
  const double c = std::cos(angle), s = std::sin(angle);
  for (Vec2& v : p) v = scale * Vec2(c * v.x() - s * v.y(), s * v.x() + c * v.y()) + shift;
  return p;
}

Features features(const std::vector<Polygon>& material, const Polygon& domain = kDomain,
                  const std::vector<Polygon>& voids = {}) {
  return smallest_features(unite(material, {domain, {}}, voids), {domain, {}});
}

/// Returns a bar of the given half-length and half-thickness with square ends, around a point.
Polygon bar(const Vec2& center, double length, double thickness, double angle) {
  return turned(box(-length, -thickness, length, thickness), angle, 1, center);
}

// Straight outlines are exact to round-off (1e-12 for sizes of 1, and 1e-9 for the test of empty
// discs).
constexpr double kExact = 1e-11;

TEST(SmallestFeature, OfARectangleIsItsShorterSide) {
  const Features f = features({box(0, 0, 2, 0.3)});
  EXPECT_NEAR(f.solid, 0.3, kExact);
  EXPECT_EQ(f.gap, kInfinity);
  EXPECT_NEAR(features({box(0, 0, 1, 1)}).solid, 1, kExact);
}

TEST(SmallestFeature, OfTwoBarsIsTheThinnerOneAndTheGapBetween) {
  const Features f = features({box(0, 0, 1, 0.1), box(0, 0.13, 1, 0.33)});
  EXPECT_NEAR(f.solid, 0.1, kExact);
  EXPECT_NEAR(f.gap, 0.03, kExact);
  // The gap between a corner and a side is the distance of the corner from the line.
  const double angle = 0.7, lift = 0.02;
  const Polygon upper = bar({0, 0}, 0.5, 0.1, angle);
  double lowest = kInfinity;
  for (const Vec2& v : upper) lowest = std::min(lowest, v.y());
  Polygon lower = box(-2, lowest - lift - 0.4, 2, lowest - lift);
  EXPECT_NEAR(features({upper, lower}).gap, lift, kExact);
}

TEST(SmallestFeature, OfAVerySmallGapBetweenBars) {
  EXPECT_NEAR(features({box(0, 0, 1, 0.1), box(0, 0.1 + 1e-6, 1, 0.2)}).gap, 1e-6, kExact);
}

TEST(SmallestFeature, OfANeckIsItsWidth) {
  EXPECT_NEAR(features({box(0, 0, 1, 1), box(0.9, 0.4, 2.1, 0.6), box(2, 0, 3, 1)}).solid, 0.2,
              kExact);
  // For bars that meet at their corners it is the distance of the two vertices where their outlines
  // cross.
  EXPECT_NEAR(features({box(0, 0, 1, 0.2), box(0.95, 0.15, 2, 0.35)}).solid, std::hypot(0.05, 0.05),
              kExact);
}

TEST(SmallestFeature, OfAnHourglassIsTheDistanceOfItsArcs) {
  // A block has two round voids at its sides, 0.3 apart; the polygons are within the sagitta of the
  // arcs.
  const int n = 160;
  const double sagitta = 1 - std::cos(std::numbers::pi / n);
  const Features f =
      features({box(-2, -1, 2, 1)}, kDomain, {circle({0, 1.15}, 1, n), circle({0, -1.15}, 1, n)});
  EXPECT_NEAR(f.solid, 0.3, 4 * sagitta);
}

TEST(SmallestFeature, OfATaperedBarIsItsThinEnd) {
  // Between two blocks the width is that of the reflex corners at the thin end.
  const Polygon taper = {{0, -0.05}, {2, -0.15}, {2, 0.15}, {0, 0.05}};
  EXPECT_NEAR(features({taper, box(-1, -0.5, 0.0, 0.5), box(2, -0.5, 3, 0.5)}).solid, 0.1, kExact);
  // A free bar with a round tip is the hull of two discs.
  const double R = 0.2, r = 0.05, distance = 2;
  const double lean = std::asin((R - r) / distance);
  Polygon hull = circle({0, 0}, R, 60, std::numbers::pi / 2 - lean, 1.5 * std::numbers::pi + lean);
  const Polygon tip =
      circle({distance, 0}, r, 40, 1.5 * std::numbers::pi + lean, 2.5 * std::numbers::pi - lean);
  hull.insert(hull.end(), tip.begin(), tip.end());
  EXPECT_NEAR(features({hull}).solid, 2 * r, 2 * r * (1 - std::cos(std::numbers::pi / 78)));
  // For a free bar cut square at w = 0.1, the disc touches the end and both sides, whose slope is
  // b: r = w/2 cos b / (1 - sin b).
  const double slope = std::atan(0.05);
  EXPECT_NEAR(features({taper}).solid, 0.1 * std::cos(slope) / (1 - std::sin(slope)), kExact);
}

TEST(SmallestFeature, OfARingIsItsWallAndItsHole) {
  const int n = 120;
  const std::vector<Region> ring = unite(std::vector<Polygon>{circle({0, 0}, 1, n)}, {kDomain, {}},
                                         std::vector<Polygon>{circle({0, 0}, 0.7, n)});
  const Features f = smallest_features(ring, {kDomain, {}});
  const double sagitta = 1 - std::cos(std::numbers::pi / n);
  EXPECT_NEAR(f.solid, 0.3, 2 * sagitta);
  EXPECT_NEAR(f.gap, 1.4, 2 * sagitta);
  // A hole is near an edge.
  EXPECT_NEAR(features({box(0, 0, 2, 1)}, kDomain, {circle({1, 0.3}, 0.25, n)}).solid, 0.05,
              2 * sagitta);
}

TEST(SmallestFeature, OfAnAngleIsItsThinnerArm) {
  EXPECT_NEAR(features({box(0, 0, 1, 0.2), box(0, 0, 0.3, 1)}).solid, 0.2, kExact);
}

/// Returns the diameter of the largest disc that touches the tip of a superellipse of constant
/// half-thickness g from within, at the end of its medial axis.
double end_disc(double L, double g) {
  double low = 0, high = g;
  for (int step = 0; step < 60; ++step) {
    const double r = 0.5 * (low + high);
    bool fits = true;
    for (int k = 0; k <= 20000 && fits; ++k) {
      const double x = L - 2 * r * k / 20000.0, u = x / L;
      const double y = g * std::pow(1 - u * u * u * u * u * u, 1.0 / 6);
      fits = std::hypot(x - (L - r), y) >= r * (1 - 1e-9);
    }
    (fits ? low : high) = r;
  }
  return 2 * low;
}

// The tips of a slender superellipse taper over a considerable part of its length, so that a free
// end is thinner than the middle.
TEST(SmallestFeature, OfCrossingComponentsIsTheThinnerOne) {
  const Component thin{{0, 0}, 1, 0.6, 0.1, 0.1, 0.1}, thick{{0.1, 0}, 1, -0.9, 0.15, 0.15, 0.15};
  const Features f =
      features({outline_within(thin, 1e-3, 1e-5), outline_within(thick, 1e-3, 1e-5)});
  EXPECT_NEAR(f.solid, end_disc(1, 0.1), 1e-4);
  EXPECT_EQ(f.gap, kInfinity);  // wedges between bars are no gaps
}

TEST(SmallestFeature, CutsByTheBorderAreNoFeatures) {
  const Polygon domain = box(0, 0, 2, 1);
  // Oblique bars end at the border, and one bar is partly outside: a strip of 0.07 remains.
  EXPECT_NEAR(features({bar({1, 0.5}, 3, 0.1, 0.5)}, domain).solid, 0.2, kExact);
  EXPECT_NEAR(features({bar({1, 0.5}, 3, 0.1, 1.3)}, domain).solid, 0.2, kExact);
  EXPECT_NEAR(features({box(-1, -0.2, 3, 0.07)}, domain).solid, 0.07, kExact);
  // Void between a bar and the border is no gap.
  EXPECT_EQ(features({box(0, 0.01, 2, 0.5)}, domain).gap, kInfinity);
}

TEST(SmallestFeature, OfPiecesThatShareAVertexIsZero) {
  EXPECT_EQ(features({box(0, 0, 1, 1), box(1, 1, 2, 2)}).solid, 0);
}

TEST(SmallestFeature, OfPiecesThatHardlyTouchIsWhatTheyShare) {
  const double overlap = 1e-9;
  const Features f = features({box(0, 0, 1, 1), box(1 - overlap, 1 - overlap, 2, 2)});
  EXPECT_NEAR(f.solid, std::sqrt(2) * overlap, 1e-12);
}

TEST(SmallestFeature, OfABladeIsZeroAndOfACornerIsNot) {
  const auto wedge = [](double angle) {
    return Polygon{{0, 0}, {1, -std::tan(angle / 2)}, {1, std::tan(angle / 2)}};
  };
  EXPECT_EQ(features({wedge(0.3)}).solid, 0);
  // The diameter of the incircle of a triangle is two times its area divided by half its perimeter.
  const double tall = 2 * std::tan(0.35), slant = std::hypot(1, tall / 2);
  EXPECT_NEAR(features({wedge(0.7)}).solid, 2 * tall / (2 * slant + tall), kExact);
}

TEST(SmallestFeature, TurnsAndScales) {
  const std::vector<Polygon> shape = {box(0, 0, 1, 0.2), box(0.95, 0.15, 2, 0.35),
                                      box(0, 0.28, 0.9, 0.5)};
  const Features plain = features(shape);
  EXPECT_NEAR(plain.solid, std::hypot(0.05, 0.05), kExact);
  EXPECT_NEAR(plain.gap, 0.05, kExact);
  for (const double scale : {1e-3, 1.0, 1e3})
    for (const double angle : {0.1, 0.7853981633974483, 1.2345}) {
      std::vector<Polygon> moved;
      for (const Polygon& p : shape) moved.push_back(turned(p, angle, scale));
      const Features f = features(moved, turned(kDomain, angle, scale));
      EXPECT_NEAR(f.solid, scale * plain.solid, 1e-8 * scale) << scale << " " << angle;
      EXPECT_NEAR(f.gap, scale * plain.gap, 1e-8 * scale) << scale << " " << angle;
    }
}

/// Returns points of the outlines, about `step` apart.
Polygon samples(const std::vector<Region>& regions, double step) {
  Polygon out;
  const auto walk = [&](const Polygon& ring) {
    for (size_t k = 0; k < ring.size(); ++k) {
      const Vec2 &p = ring[k], along = ring[(k + 1) % ring.size()] - p;
      const int n = static_cast<int>(std::ceil(along.norm() / step));
      for (int i = 0; i < n; ++i) out.push_back(p + along * i / n);
    }
  };
  for (const Region& r : regions) {
    walk(r.outer);
    for (const Polygon& hole : r.holes) walk(hole);
  }
  return out;
}

double distance_to(const Polygon& points, const Vec2& p) {
  double out = kInfinity;
  for (const Vec2& q : points) out = std::min(out, (p - q).norm());
  return out;
}

// This test is independent of the Voronoi graph: it samples the outlines. Every reported disc is
// inscribed and touches them. Two samples whose disc is empty and inside the material are a neck
// (or a bar) of about their distance, so that no much smaller width can have been missed.
TEST(LengthScaleViolations, OfRandomDesignsAgreeWithSampledOutlines) {
  const Region domain{box(0, 0, 2, 1), {}};
  const double step = 0.01;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    test::RandomComponents random(seed);
    std::vector<Polygon> outlines;
    for (const Component& c : random.several(12, 2, 1))
      outlines.push_back(outline_within(c, 0.02, 1e-4));
    const std::vector<Region> regions = unite(outlines, domain, {});
    const Polygon points = samples(regions, step);
    const std::vector<LengthScaleViolation> locations =
        length_scale_violations(regions, domain, 0.2);
    for (const LengthScaleViolation& p : locations) {
      if (p.width == 0) continue;
      EXPECT_NEAR(distance_to(points, p.center), 0.5 * p.width,
                  step * step / (4 * p.width) + 1e-9 + step * (p.width < step));
      EXPECT_NEAR((p.a - p.center).norm(), 0.5 * p.width, 1e-6 * p.width);
      EXPECT_NEAR((p.b - p.center).norm(), 0.5 * p.width, 1e-6 * p.width);
      bool inside = false;
      for (const Region& r : regions) inside = inside || contains(r, p.center);
      EXPECT_EQ(inside, p.solid) << seed;
    }
    double sampled = 0.2, sampled_gap = 0.2;
    const auto on_border = [&](const Vec2& p) {
      return p.x() < 1e-9 || p.x() > 2 - 1e-9 || p.y() < 1e-9 || p.y() > 1 - 1e-9;
    };
    for (size_t i = 0; i < points.size(); ++i)
      for (size_t j = i + 1; j < points.size(); ++j) {
        const Vec2 center = 0.5 * (points[i] + points[j]);
        const double width = (points[i] - points[j]).norm();
        if (width >= std::max(sampled, sampled_gap) || width < 5 * step) continue;
        if (distance_to(points, center) < 0.5 * width * (1 - 1e-6)) continue;
        bool inside = false;
        for (const Region& r : regions) inside = inside || contains(r, center);
        const bool border = on_border(points[i]) || on_border(points[j]);
        if (inside) sampled = std::min(sampled, width);
        if (!inside && !border) sampled_gap = std::min(sampled_gap, width);
      }
    double found = 0.2, found_gap = 0.2;
    for (const LengthScaleViolation& p : locations) {
      double& smallest = p.solid ? found : found_gap;
      smallest = std::min(smallest, p.width);
    }
    EXPECT_LE(found, sampled + 1e-9) << seed;
    EXPECT_LE(found_gap, sampled_gap + 1e-9) << seed;
  }
}

bool same(const LengthScaleViolation& x, const LengthScaleViolation& y) {
  return x.kind == y.kind && x.solid == y.solid && x.width == y.width && x.center == y.center &&
         x.a == y.a && x.b == y.b;
}
bool same(const std::vector<LengthScaleViolation>& x, const std::vector<LengthScaleViolation>& y) {
  return std::equal(x.begin(), x.end(), y.begin(), y.end(),
                    [](const LengthScaleViolation& one, const LengthScaleViolation& other) {
                      return same(one, other);
                    });
}

/// Returns shapes with many ties, where round-off decides: pairs of crossing square bars on a
/// lattice, so that discs have four contacts and many widths are equal; and a random shape.
std::vector<std::vector<Region>> shapes(const Region& domain) {
  std::vector<Polygon> lattice, outlines;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 2; ++j)
      for (const double angle : {-0.7, 0.7})
        lattice.push_back(bar({(i + 0.5) / 2, (j + 0.5) / 2}, 0.3, 0.03, angle));
  test::RandomComponents random(5);
  for (const Component& c : random.several(12, 2, 1))
    outlines.push_back(outline_within(c, 0.02, 1e-2));
  const Polygon hole = bar({0.5, 0.5}, 0.1, 0.1, 0.0);
  return {unite(lattice, domain, {}), unite(outlines, domain, std::vector<Polygon>{hole})};
}

Features smallest_of(const std::vector<LengthScaleViolation>& locations) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Features out{kInfinity, kInfinity};
  for (const LengthScaleViolation& p : locations) {
    double& smallest = p.solid ? out.solid : out.gap;
    smallest = std::min(smallest, p.width);
  }
  return out;
}

// The smallest feature, of the design and of its counted region, must be the smallest of all
// locations.
TEST(SmallestFeature, IsTheSmallestOfAllLocations) {
  const Region domain{box(0, 0, 2, 1), {}};
  for (unsigned seed = 1; seed <= 20; ++seed) {
    test::RandomComponents random(seed);
    std::vector<Polygon> outlines;
    for (const Component& c : random.several(20, 2, 1))
      outlines.push_back(outline_within(c, 0.02, 1e-3));
    const std::vector<Region> regions = unite(outlines, domain, {});
    for (const double left : {0.0, 0.7, 3.0}) {
      const auto counts = [left](const LengthScaleViolation& p) { return p.center.x() > left; };
      std::vector<LengthScaleViolation> locations =
          length_scale_violations(regions, domain, std::numeric_limits<double>::infinity());
      std::erase_if(locations, [&](const LengthScaleViolation& p) { return !counts(p); });
      EXPECT_EQ(locations.empty(), left > 2) << seed;  // no location is outside the domain
      const Features all = smallest_of(locations),
                     found = smallest_features(regions, domain, counts);
      EXPECT_EQ(found.solid, all.solid) << seed;
      EXPECT_EQ(found.gap, all.gap) << seed;
    }
  }
}

// Sides that overlap need rational numbers: a design with a region without area must have all
// violations of the design without this region.
TEST(LengthScaleViolations, OfSidesThatCross) {
  const Region domain{box(0, 0, 2, 1), {}};
  const std::vector<Region> apart = {{box(0.1, 0.1, 0.5, 0.9), {}}, {box(0.8, 0.1, 1.5, 0.9), {}}};
  std::vector<Region> crossing = apart;
  crossing.push_back({{{1.6, 0.2}, {1.7, 0.2}, {1.65, 0.2}}, {}});  // no area: its sides overlap
  const std::vector<LengthScaleViolation> expected = length_scale_violations(apart, domain, 0.75),
                                          found = length_scale_violations(crossing, domain, 0.75);
  for (const LengthScaleViolation& p : expected)
    EXPECT_TRUE(std::any_of(found.begin(), found.end(), [&](const LengthScaleViolation& q) {
      return q.kind == p.kind && q.solid == p.solid && q.width == p.width && q.center == p.center;
    })) << p.width;
}

// By default CGAL orders its objects by address; then no two calls would agree.
TEST(LengthScaleViolations, AreTheSameBitForBitWhereverTheHeapPutsThings) {
  const Region domain{box(0, 0, 2, 1), {}};
  test::ScrambledHeap heap(1);
  for (const std::vector<Region>& regions : shapes(domain)) {
    const std::vector<LengthScaleViolation> first = length_scale_violations(regions, domain, 0.2);
    ASSERT_GT(first.size(), 50u);
    for (int k = 0; k < 20; ++k) {
      heap.again();
      EXPECT_TRUE(same(length_scale_violations(regions, domain, 0.2), first)) << k;
    }
  }
}

TEST(LengthScaleViolations, AreTheSameBitForBitWhereverRingsBegin) {
  const Region domain{box(0, 0, 2, 1), {}};
  std::mt19937 engine(1);
  for (std::vector<Region> regions : shapes(domain)) {
    const std::vector<LengthScaleViolation> first = length_scale_violations(regions, domain, 0.2);
    const auto rotate = [&](Polygon& ring) {
      std::rotate(ring.begin(), ring.begin() + static_cast<std::ptrdiff_t>(engine() % ring.size()),
                  ring.end());
    };
    for (int k = 0; k < 20; ++k) {
      for (Region& r : regions) {
        rotate(r.outer);
        std::for_each(r.holes.begin(), r.holes.end(), rotate);
        std::shuffle(r.holes.begin(), r.holes.end(), engine);
      }
      std::shuffle(regions.begin(), regions.end(), engine);
      EXPECT_TRUE(same(length_scale_violations(regions, domain, 0.2), first)) << k;
    }
  }
}

}  // namespace
}  // namespace flexmorph
