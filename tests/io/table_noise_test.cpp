// Shows that noise in tables is measured as theory says, and that smooth tables, also rounded ones,
// have none.
#include "io/table_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace flexmorph::io {
namespace {

struct NoisyPoints {
  std::vector<double> t, x;
};

/// Returns n points of a function in [0, 1].
template <class Function>
NoisyPoints points(int n, Function f) {
  NoisyPoints out;
  for (int i = 0; i < n; ++i) {
    out.t.push_back(i / (n - 1.0));
    out.x.push_back(f(out.t.back()));
  }
  return out;
}

std::optional<TableNoise> noise_of(const NoisyPoints& p) { return io::noise_of(p.t, p.x); }

// Of independent errors, second differences have the covariances 6, -4, 1, so that the signs of
// neighbours differ with the probability 1/2 + asin(4/6)/pi, and the ratio is 4^2.
TEST(TableNoise, OfIndependentErrorsIsAsTheoryAdvises) {
  std::mt19937 random(3);
  std::normal_distribution<double> error(0, 0.01);
  const auto noise = noise_of(points(4001, [&](double t) { return std::sin(t) + error(random); }));
  ASSERT_TRUE(noise);
  // The standard deviations of both estimates of 4000 points are near 0.01 and 2 %.
  EXPECT_NEAR(noise->sign_changes, 0.5 + std::asin(2.0 / 3) / std::numbers::pi, 0.04);
  EXPECT_NEAR(noise->ratio, 16, 1.5);
}

TEST(TableNoise, OfAShortMeasuredTableIsFound) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> error(-0.02, 0.02);
  EXPECT_TRUE(
      noise_of(points(51, [&](double t) { return 2 * std::numbers::pi * t + error(random); })));
  // Uneven times do not matter.
  NoisyPoints p = points(51, [&](double t) { return 2 * std::numbers::pi * t + error(random); });
  for (double& t : p.t) t = t * t + 0.1 * t;
  EXPECT_TRUE(noise_of(p));
}

TEST(TableNoise, IsAbsentFromSmoothTables) {
  const auto rounded = [](double x, double digit) { return std::round(x / digit) * digit; };
  EXPECT_FALSE(noise_of(points(51, [](double t) { return t; })));
  EXPECT_FALSE(noise_of(points(51, [](double) { return 1.0; })));
  EXPECT_FALSE(noise_of(points(31, [](double t) { return std::sin(10 * std::numbers::pi * t); })));
  EXPECT_FALSE(noise_of(points(51, [](double t) { return t < 0.5 ? 0.0 : 1.0; })));
  EXPECT_FALSE(
      noise_of(points(51, [&](double t) { return rounded(2 * std::numbers::pi * t, 1e-4); })));
  EXPECT_FALSE(noise_of(points(1001, [&](double t) { return rounded(std::sin(9 * t), 1e-6); })));
  EXPECT_FALSE(noise_of(points(8, [](double t) { return std::sin(1e4 * t); })));
}

}  // namespace
}  // namespace flexmorph::io
