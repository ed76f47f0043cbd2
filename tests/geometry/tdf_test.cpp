// Shows that the TDF of one component and the Heaviside function have the right values, derivatives
// by all seven parameters, and the unit slope that makes the band a length.

#include "geometry/components/tdf.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/geometry/random_components.h"

namespace flexmorph {
namespace {

using test::RandomComponents;
using Kind = TdfSettings::Kind;

TdfSettings settings(Kind kind) { return {.kind = kind, .min_half_thickness = 0.03}; }

Vec2 point_of(const Component& c, double x, double y) {
  return c.center + Vec2(std::cos(c.angle) * x - std::sin(c.angle) * y,
                         std::sin(c.angle) * x + std::cos(c.angle) * y);
}

class EveryKind : public ::testing::TestWithParam<Kind> {};
INSTANTIATE_TEST_SUITE_P(Tdf, EveryKind, ::testing::Values(Kind::distance, Kind::paper));

TEST_P(EveryKind, HeavisideHasItsEndsItsMiddleAndNoSteps) {
  TdfSettings s = settings(GetParam());
  const double band = s.band = 0.3, alpha = s.alpha;
  EXPECT_EQ(heaviside(0.31, s).value, 1);
  EXPECT_EQ(heaviside(-0.31, s).value, alpha);
  EXPECT_EQ(heaviside(0.31, s).slope, 0);
  EXPECT_EQ(heaviside(-0.31, s).slope, 0);
  EXPECT_NEAR(heaviside(0, s).value, 0.5 * (1 + alpha), 1e-16);
  const double middle = GetParam() == Kind::paper ? 0.75 : 15.0 / 16;
  EXPECT_NEAR(heaviside(0, s).slope, middle * (1 - alpha) / band, 1e-15);
  for (const double end : {-band, band}) {  // value and slope are continuous
    const Heaviside in = heaviside(end * (1 - 1e-9), s), out = heaviside(end * (1 + 1e-9), s);
    EXPECT_NEAR(in.value, out.value, 1e-15);  // the slope vanishes there: 1e-9 squared
    EXPECT_NEAR(in.slope, out.slope, 1e-8 / band);
    if (GetParam() == Kind::distance) {
      EXPECT_NEAR(in.curvature, 0, 1e-7 / (band * band));
    }
  }
  const double h = 1e-5;  // truncation H''' h²/6 = 6e-9, round-off 1e-11
  for (double phi = -0.29; phi < 0.3; phi += 0.02) {
    const Heaviside up = heaviside(phi + h, s), down = heaviside(phi - h, s);
    EXPECT_NEAR(heaviside(phi, s).slope, (up.value - down.value) / (2 * h), 1e-8);
    EXPECT_NEAR(heaviside(phi, s).curvature, (up.slope - down.slope) / (2 * h), 1e-7);
  }
}

TEST(ComponentTdf, TakesThePrintedValues) {
  RandomComponents random(1);
  for (int k = 0; k < 500; ++k) {
    const Component c = random.next();
    const double x = random.uniform(-1.5, 1.5) * c.half_length, y = random.uniform(-0.3, 0.3);
    const Vec2 at = point_of(c, x, y);
    const double g = profile(c, x, 0.03).g;
    const double sum = std::pow(x / c.half_length, 6) + std::pow(y / g, 6);
    EXPECT_NEAR(component_tdf(c, settings(Kind::paper), at.x(), at.y(), nullptr), 1 - sum,
                1e-12 * (1 + sum));
    // The expected φ is (1 - s)/|∇s| at this g outside, blended with about (1 - s) g towards the
    // center, limited to g by an eighth-power mean; the slope of s comes from differences.
    const auto s = [&](double X, double Y) {
      return std::pow(std::pow(X / c.half_length, 6) + std::pow(Y / g, 6), 1.0 / 6);
    };
    const double h = 1e-6, here = s(x, y);
    const double slope =
        std::hypot((s(x + h, y) - s(x - h, y)) / (2 * h), (s(x, y + h) - s(x, y - h)) / (2 * h));
    const double inside = std::min(1.0, here), w = inside * inside * (3 - 2 * inside);
    const double rounded = 1 + inside * std::pow(1 - inside, 4);
    const double P = (1 - here) * (w / slope + (1 - w) * rounded * g);
    const double phi = P > 0 ? P * std::pow(1 + std::pow(P / g, 8), -0.125) : P;
    // The error of the difference quotient is h² s‴/6, with s‴ up to 1/g³ off the center.
    if (here < 0.1) continue;
    EXPECT_NEAR(component_tdf(c, settings(Kind::distance), at.x(), at.y(), nullptr), phi, 1e-6);
  }
}

/// Returns the largest error of the derivatives against central differences, relative to the
/// largest derivative at the point. For h = 1e-6 the truncation h² φ'''/φ' is below 1e-8 for the
/// sizes here (the shortest length is 0.03 / p), and the round-off 1e-16/h is 1e-10.
double derivative_error(const Component& c, const TdfSettings& s, const Vec2& at) {
  double d[7];
  component_tdf(c, s, at.x(), at.y(), d);
  double largest = 0, error = 0;
  for (int q = 0; q < 7; ++q) {
    const double h = 1e-6;
    auto up = c.parameters(), down = up;
    up[q] += h;
    down[q] -= h;
    const double difference =
        (component_tdf(Component::from_parameters(up.data()), s, at.x(), at.y(), nullptr) -
         component_tdf(Component::from_parameters(down.data()), s, at.x(), at.y(), nullptr)) /
        (2 * h);
    largest = std::max(largest, std::abs(d[q]));
    error = std::max(error, std::abs(d[q] - difference));
  }
  return error / largest;
}

TEST_P(EveryKind, DerivativesMeetDifferences) {
  RandomComponents random(2);
  int tested = 0;
  for (int k = 0; k < 1000; ++k) {
    const Component c = random.next();
    const double x = random.uniform(-1.5, 1.5) * c.half_length, y = random.uniform(-0.2, 0.2);
    if (std::hypot(x / c.half_length, y / 0.03) < 0.02) continue;  // large second derivatives
    EXPECT_LT(derivative_error(c, settings(GetParam()), point_of(c, x, y)), 1e-6)
        << "x/L " << x / c.half_length << " y " << y;
    ++tested;
  }
  EXPECT_GT(tested, 900);
}

TEST_P(EveryKind, CenterIsFiniteAndFlat) {
  const Component c{
      .center = {0.3, 0.2}, .half_length = 0.5, .angle = 0.3, .c1 = 0.1, .c2 = 0.1, .c3 = 0.15};
  for (const double off : {0.0, 1e-200, 1e-60, 1e-30}) {
    double d[7];
    const double phi = component_tdf(c, settings(GetParam()), 0.3, 0.2 + off, d);
    if (GetParam() == Kind::paper) {
      EXPECT_NEAR(phi, 1, 1e-15);
    } else {
      EXPECT_NEAR(phi, 0.15 * std::pow(2, -0.125), 1e-15);  // P = g with the limit
    }
    for (const double each : d) EXPECT_TRUE(std::isfinite(each));
  }
  double d[7];
  component_tdf(c, settings(GetParam()), 0.3, 0.2, d);
  for (int q = 0; q < 4; ++q) EXPECT_EQ(d[q], 0) << q;  // by X0, Y0, L, θ
}

// φ is a length: across a long side, away from the corners, it falls by 1 per unit length. At |x| =
// L/2 the exponent 6 leaves 1 - 5/6 (1/2)^6 = 0.987, and a tapered g adds g'²/2.
TEST(ComponentTdf, HasUnitSlopeAcrossTheFlank) {
  RandomComponents random(3);
  for (int k = 0; k < 300; ++k) {
    Component c = random.next();
    c.c1 = c.c2 = c.c3 = random.uniform(0.04, 0.1);
    c.c2 *= 0.9;  // slopes up to 0.1
    const double x = random.uniform(-0.5, 0.5) * c.half_length;
    const double g = profile(c, x, 0.03).g;
    const double y = (k % 2 == 0 ? 1 : -1) * random.uniform(0.9, 1.3) * g;
    const Vec2 at = point_of(c, x, y);
    const TdfSettings s = settings(Kind::distance);
    const double h = 1e-6;
    const auto phi = [&](double X, double Y) { return component_tdf(c, s, X, Y, nullptr); };
    const Vec2 gradient((phi(at.x() + h, at.y()) - phi(at.x() - h, at.y())) / (2 * h),
                        (phi(at.x(), at.y() + h) - phi(at.x(), at.y() - h)) / (2 * h));
    EXPECT_NEAR(gradient.norm(), 1, 0.03);
  }
}

// φ must fall by 1 per unit length also at a tip, where 1 - s alone falls by 1/L and (1 - s) g by
// g/L only; therefore the band does not bridge gaps between the ends of components.
TEST(ComponentTdf, HasUnitSlopeAtTheTip) {
  const Component c{
      .center = {0.3, 0.2}, .half_length = 0.5, .angle = 0.3, .c1 = 0.1, .c2 = 0.1, .c3 = 0.1};
  const TdfSettings s = settings(Kind::distance);
  for (const double beyond : {-0.04, -0.01, 0.01, 0.04, 0.08}) {
    const Vec2 at = point_of(c, c.half_length + beyond, 0.02);
    // Inside the component, the weight of the end and the limit of the distance change the value:
    // at a depth of 0.4 half-thicknesses g by the fraction 2 (0.08) (1 - g/L).
    EXPECT_NEAR(component_tdf(c, s, at.x(), at.y(), nullptr), -beyond, 0.006) << beyond;
  }
}

}  // namespace
}  // namespace flexmorph
