// Shows that limit loads are found on paths whose limit loads are known.
#include "cases/results/limit_points.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace flexmorph::cases {
namespace {

// The vertex of a parabola is found exactly, whatever the steps.
TEST(LimitLoads, OfAParabolaAreExact) {
  const std::vector<double> arc = {0, 0.1, 0.7, 1.5, 1.6};
  std::vector<double> factor;
  for (const double s : arc) factor.push_back(3 - 2 * (s - 0.9) * (s - 0.9));
  const std::vector<double> found = limit_loads(arc, factor);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0], 3, 1e-14);
}

// exp(-s/4) sin s has extremes where tan s = 4 and half a turn later. Both are found in order, with
// an error of order 3 or better on unequal steps.
TEST(LimitLoads, AreOfThirdOrder) {
  const auto load = [](double s) { return std::exp(-s / 4) * std::sin(s); };
  const double top = std::atan(4.0), bottom = top + std::numbers::pi;
  const auto error = [&](double h) {
    std::vector<double> arc, factor;
    for (double s = 0; s < 6; s += h * (1 + 0.3 * std::sin(7 * s))) {
      arc.push_back(s);
      factor.push_back(load(s));
    }
    const std::vector<double> found = limit_loads(arc, factor);
    EXPECT_EQ(found.size(), 2u);
    return std::max(std::abs(found.at(0) - load(top)), std::abs(found.at(1) - load(bottom)));
  };
  EXPECT_LT(error(0.1), 1e-4);
  EXPECT_LT(error(0.01), 1e-7);
}

TEST(LimitLoads, ALoadThatOnlyGrowsHasNone) {
  EXPECT_TRUE(
      limit_loads(std::vector<double>{0, 1, 2, 4}, std::vector<double>{0, 1, 3, 9}).empty());
}

}  // namespace
}  // namespace flexmorph::cases
