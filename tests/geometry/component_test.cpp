// Shows that the profile of a component is P (26) with a smooth lower bound and exact derivatives,
// that its outline is on χ = 0 of P (24), and that its box contains the outline.

#include "geometry/components/component.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/geometry/random_components.h"

namespace flexmorph {
namespace {

using test::RandomComponents;

/// Returns P (26) as printed.
double printed_profile(const Component& c, double x) {
  const double L = c.half_length;
  return (c.c1 + c.c2 - 2 * c.c3) / (2 * L * L) * x * x + (c.c2 - c.c1) / (2 * L) * x + c.c3;
}

/// Returns P (24), (25) as printed, for profiles above their lower bound.
double printed_chi(const Component& c, const Vec2& point) {
  const double dX = point.x() - c.center.x(), dY = point.y() - c.center.y();
  const double x = std::cos(c.angle) * dX + std::sin(c.angle) * dY;
  const double y = -std::sin(c.angle) * dX + std::cos(c.angle) * dY;
  return 1 - std::pow(x / c.half_length, 6) - std::pow(y / printed_profile(c, x), 6);
}

double polygon_area(const std::vector<Vec2>& p) {
  double twice = 0;
  for (std::size_t k = 0; k < p.size(); ++k) {
    const Vec2 &a = p[k], &b = p[(k + 1) % p.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * twice;
}

TEST(Component, ParametersRoundTrip) {
  const Component c = RandomComponents(1).next();
  const auto p = c.parameters();
  EXPECT_EQ(Component::from_parameters(p.data()).parameters(), p);
  EXPECT_EQ(p[2], c.half_length);
  EXPECT_EQ(p[3], c.angle);
  EXPECT_EQ(p[6], c.c3);
}

TEST(Profile, IsThePrintedParabolaAboveItsBoundAndConstantOutside) {
  RandomComponents random(2);
  for (int k = 0; k < 200; ++k) {
    const Component c = random.next();
    const double L = c.half_length, x = random.uniform(-L, L);
    if (printed_profile(c, x) > 0.0111) {
      EXPECT_NEAR(profile(c, x, 0.01).g, printed_profile(c, x), 1e-15);
    }
    EXPECT_NEAR(profile(c, -L, 0.01).g, c.c1, 1e-15);
    EXPECT_NEAR(profile(c, 0, 0.01).g, c.c3, 1e-15);
    const double beyond = printed_profile(c, 1.1 * L);
    if (beyond > 0.0111) {
      EXPECT_NEAR(profile(c, 3 * L, 0.01).g, beyond, 1e-15);
    }
    EXPECT_EQ(profile(c, 3 * L, 0.01).dg_dx, 0);
    EXPECT_EQ(profile(c, 3 * L, 0.01).dg_dp[0], 0);
  }
}

TEST(Profile, BoundIsTheRoundedMaximum) {
  // A straight profile maps x to g, so that one loop covers the three branches of the header.
  const double m = 0.1, d = 0.01;
  const Component c{.half_length = 1, .c1 = 0, .c2 = 0.2, .c3 = 0.1};
  const auto rounded = [&](double t) { return 2 * d * (t * t * t - 0.5 * t * t * t * t); };
  for (double x = -1; x <= 1; x += 1.0 / 512) {
    const double g = 0.1 + 0.1 * x;
    const double expected = g >= m + d            ? g
                            : std::abs(g - m) < d ? m + rounded((g - m + d) / (2 * d))
                                                  : m;
    EXPECT_NEAR(profile(c, x, m).g, expected, 4e-16) << x;
  }
}

TEST(Profile, IsNeverBelowTheMinimum) {
  RandomComponents random(3);
  const double m = 0.05;
  for (int k = 0; k < 2000; ++k) {
    Component c = random.next();
    c.c3 = random.uniform(-0.1, 0.1);
    const double x = random.uniform(-2, 2) * c.half_length;
    EXPECT_GE(profile(c, x, m).g, m);
  }
}

// Derivatives are of order 1. Central differences with h = 1e-6 have a truncation error of h²
// g'''/6, 1e-9 where the bound of 0.01 is rounded.
TEST(Profile, DerivativesMeetDifferences) {
  RandomComponents random(4);
  int tested = 0;
  for (int k = 0; k < 3000; ++k) {
    const Component c = random.next();
    const double m = random.uniform(0.01, 0.1);
    const double x = random.uniform(-1.5, 1.5) * c.half_length;
    const Profile p = profile(c, x, m);
    const double h = 1e-6;
    const double by_x = (profile(c, x + h, m).g - profile(c, x - h, m).g) / (2 * h);
    EXPECT_NEAR(p.dg_dx, by_x, 1e-6);
    constexpr int kNumbers[] = {2, 4, 5, 6};  // L, c1, c2, c3 among the seven parameters
    for (int q = 0; q < 4; ++q) {
      auto up = c.parameters(), down = up;
      up[kNumbers[q]] += h;
      down[kNumbers[q]] -= h;
      const double by_p = (profile(Component::from_parameters(up.data()), x, m).g -
                           profile(Component::from_parameters(down.data()), x, m).g) /
                          (2 * h);
      EXPECT_NEAR(p.dg_dp[q], by_p, 1e-6) << q;
    }
    ++tested;
  }
  EXPECT_GT(tested, 2500);
}

TEST(Outline, LiesOnTheZeroLevelAndRunsCounterclockwise) {
  RandomComponents random(5);
  for (int k = 0; k < 50; ++k) {
    Component c = random.next();
    c.c3 = random.uniform(0.6, 1.4) * 0.5 * (c.c1 + c.c2);  // keeps g above the bound
    const std::vector<Vec2> vertices = outline(c, 1e-4, 96);
    ASSERT_EQ(vertices.size(), 96u);
    // χ changes by 6/g per length across the outline: 1e-16 / 0.02 gives 1e-13 with a margin.
    for (const Vec2& v : vertices) EXPECT_NEAR(printed_chi(c, v), 0, 1e-12);
    EXPECT_GT(polygon_area(vertices), 0);
  }
  EXPECT_THROW(outline(Component{}, 1e-4, 2), Error);
}

// The area of |x/L|^p + |y/c|^p = 1 is 4 L c Γ(1 + 1/p)² / Γ(1 + 2/p). Chords have an error of
// O(segments^-2).
TEST(Outline, AreaConvergesToTheClosedForm) {
  const Component c{.half_length = 0.3, .angle = 0.4, .c1 = 0.05, .c2 = 0.05, .c3 = 0.05};
  const double gamma = std::tgamma(1 + 1.0 / 6);
  const double exact = 4 * 0.3 * 0.05 * gamma * gamma / std::tgamma(1 + 2.0 / 6);
  double last = 0;
  for (const int segments : {64, 128, 256, 512}) {
    const double error = std::abs(polygon_area(outline(c, 1e-4, segments)) / exact - 1);
    if (last > 0) {
      EXPECT_NEAR(std::log2(last / error), 2, 0.1) << segments;
    }
    last = error;
  }
  EXPECT_LT(last, 2e-5);
}

TEST(BoundingBox, HoldsTheOutline) {
  RandomComponents random(6);
  for (int k = 0; k < 200; ++k) {
    Component c = random.next();
    c.c3 = random.uniform(0.001, 0.4);  // many are wider than c1 and c2 between x = 0 and an end
    const Box box = bounding_box(c, 0.01, 0);
    for (const Vec2& v : outline(c, 0.01, 500)) {
      EXPECT_TRUE((v.array() >= box.lower.array() - 1e-15).all());
      EXPECT_TRUE((v.array() <= box.upper.array() + 1e-15).all());
    }
  }
}

TEST(BoundingBox, IsTheRotatedRectangleGrownByTheMargin) {
  const Component c{.center = {2, 3},
                    .half_length = 0.5,
                    .angle = std::numbers::pi / 6,
                    .c1 = 0.1,
                    .c2 = 0.1,
                    .c3 = 0.1};
  const Box box = bounding_box(c, 1e-3, 0.25);
  const double wide = 0.5 * std::cos(c.angle) + 0.1 * std::sin(c.angle) + 0.25;
  const double high = 0.5 * std::sin(c.angle) + 0.1 * std::cos(c.angle) + 0.25;
  EXPECT_NEAR((box.lower - Vec2(2 - wide, 3 - high)).norm(), 0, 1e-14);
  EXPECT_NEAR((box.upper - Vec2(2 + wide, 3 + high)).norm(), 0, 1e-14);
}

TEST(CrossingLayout, PutsTwoDiagonalsIntoEveryBox) {
  const auto all = crossing_layout(1, 2, 3, 0.8, 3, 2, 0.02, 0.5);
  ASSERT_EQ(all.size(), 12u);
  EXPECT_EQ(all[0].center, Vec2(1.5, 2.2));
  EXPECT_NEAR(all[0].angle, std::atan2(0.4, 1.0), 1e-15);
  EXPECT_EQ(all[1].center, all[0].center);
  EXPECT_EQ(all[1].angle, -all[0].angle);
  EXPECT_NEAR(all[2].center.y(), 2.6, 1e-15);  // upwards first
  EXPECT_NEAR(all[4].center.x(), 2.5, 1e-15);
  for (const Component& c : all) {
    EXPECT_EQ(c.half_length, 0.5);
    EXPECT_EQ(c.c1 + c.c2 + c.c3, 0.02 + 0.02 + 0.02);
  }
  EXPECT_THROW(crossing_layout(0, 0, 1, 1, 0, 1, 0.1, 0.5), Error);
}

}  // namespace
}  // namespace flexmorph
