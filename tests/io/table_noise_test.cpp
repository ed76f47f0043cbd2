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

constexpr double kPi = std::numbers::pi;

struct Points {
  std::vector<double> t, x;
};

/// Returns n points of a function in [0, 1].
template <class Function>
Points points(int n, Function f) {
  Points out;
  for (int i = 0; i < n; ++i) {
    out.t.push_back(i / (n - 1.0));
    out.x.push_back(f(out.t.back()));
  }
  return out;
}

std::optional<TableNoise> noise_of(const Points& p) { return io::noise_of(p.t, p.x); }

// Of independent errors, second differences have the covariances 6, -4, 1, so that the signs of
// neighbours differ with the probability 1/2 + asin(4/6)/pi, and the ratio is 4^2.
TEST(TableNoise, OfIndependentErrorsIsAsTheoryAdvises) {
  std::mt19937 random(3);
  std::normal_distribution<double> error(0, 0.01);
  const auto noise = noise_of(points(4001, [&](double t) { return std::sin(t) + error(random); }));
  ASSERT_TRUE(noise);
  // The standard deviations of both estimates of 4000 points are near 0.01 and 2 %.
  EXPECT_NEAR(noise->sign_changes, 0.5 + std::asin(2.0 / 3) / kPi, 0.04);
  EXPECT_NEAR(noise->ratio, 16, 1.5);
}

TEST(TableNoise, OfAShortMeasuredTableIsFound) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> error(-0.02, 0.02);
  EXPECT_TRUE(noise_of(points(51, [&](double t) { return 2 * kPi * t + error(random); })));
  // Uneven times do not matter.
  Points p = points(51, [&](double t) { return 2 * kPi * t + error(random); });
  for (double& t : p.t) t = t * t + 0.1 * t;
  EXPECT_TRUE(noise_of(p));
}

TEST(TableNoise, IsAbsentFromSmoothTables) {
  const auto rounded = [](double x, double digit) { return std::round(x / digit) * digit; };
  EXPECT_FALSE(noise_of(points(51, [](double t) { return t; })));
  EXPECT_FALSE(noise_of(points(51, [](double) { return 1.0; })));
  EXPECT_FALSE(noise_of(points(31, [](double t) { return std::sin(10 * kPi * t); })));
  EXPECT_FALSE(noise_of(points(51, [](double t) { return t < 0.5 ? 0.0 : 1.0; })));
  EXPECT_FALSE(noise_of(points(51, [&](double t) { return rounded(2 * kPi * t, 1e-4); })));
  EXPECT_FALSE(noise_of(points(1001, [&](double t) { return rounded(std::sin(9 * t), 1e-6); })));
  EXPECT_FALSE(noise_of(points(8, [](double t) { return std::sin(1e4 * t); })));
}

}  // namespace
}  // namespace flexmorph::io
