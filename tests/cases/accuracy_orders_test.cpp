// Shows that the convergence order and the limit of a refinement series are recovered from
// sequences whose laws are known.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "cases/study/orders.h"

namespace flexmorph::cases {
namespace {

template <class Law>
std::vector<LevelValue> sequence(const std::vector<double>& h, const Law& law) {
  std::vector<LevelValue> out;
  for (const double each : h) out.push_back({each, law(each)});
  return out;
}

const std::vector<double> kHalvedSteps = {4, 2, 1, 0.5, 0.25};
const Theory kSecond{2, "a textbook"};

TEST(Orders, ArePreciseForPowersWithAnyRatio) {
  for (const double p : {0.7, 1.0, 2.0, 4.0, 6.0})
    for (const std::vector<double>& h :
         {kHalvedSteps, std::vector<double>{1.5, 1, 0.75, 0.5, 0.3}}) {
      const auto values = sequence(h, [&](double x) { return 3 - 2 * std::pow(x, p); });
      const ExtrapolatedLimit limit = limit_of(values, Approach::power, {}, 3);
      EXPECT_TRUE(limit.converged) << limit.sentence;
      ASSERT_EQ(limit.orders.size(), 3U);
      // The values of the finest levels differ by at least 1e-3, therefore rounding leaves 12
      // digits.
      for (const double order : limit.orders) EXPECT_NEAR(order, p, 1e-9);
      EXPECT_NEAR(limit.value, 3, 1e-9);
      EXPECT_LT(limit.uncertainty, 1e-9);
    }
}

TEST(Orders, ASecondTermIsWithinTheUncertainty) {
  // Q = 1 + h² + 0.3 h⁴ at h = 0.4 .. 0.05 has the limit 1.
  const auto values =
      sequence({0.4, 0.2, 0.1, 0.05}, [](double h) { return 1 + h * h + 0.3 * std::pow(h, 4); });
  const ExtrapolatedLimit limit = limit_of(values, Approach::power, kSecond, 1);
  EXPECT_TRUE(limit.converged) << limit.sentence;
  EXPECT_NEAR(limit.order, 2, 0.02);
  EXPECT_LT(std::abs(limit.value - 1), limit.uncertainty);
  // The extrapolated limit must be more certain than the value of the finest level.
  EXPECT_LT(limit.uncertainty, 0.05 * 0.05);
}

TEST(Orders, ThatDisagreeAreNotCalledConverged) {
  // The order falls from 2 towards 1/2: the three estimates are 1.75, 1.46, 1.09.
  const auto values = sequence({1, 0.5, 0.25, 0.125, 0.0625},
                               [](double h) { return 1 + h * h + 0.3 * std::sqrt(h); });
  const ExtrapolatedLimit limit = limit_of(values, Approach::power, {}, 1);
  EXPECT_FALSE(limit.converged);
  for (const char* order : {"1.46", "1.09"})
    EXPECT_NE(limit.sentence.find(order), std::string::npos) << limit.sentence;
  EXPECT_EQ(limit.value, values.back().value);
  EXPECT_TRUE(limit.bounded());  // The differences between levels decrease.
  EXPECT_GE(limit.uncertainty, values[3].value - values[4].value);
}

TEST(Orders, OtherThanTheoryAreNotCalledConverged) {
  const auto first = sequence(kHalvedSteps, [](double h) { return 1 + h; });
  const ExtrapolatedLimit limit = limit_of(first, Approach::power, kSecond, 1);
  EXPECT_FALSE(limit.converged);
  EXPECT_NE(limit.sentence.find("a textbook"), std::string::npos) << limit.sentence;
  EXPECT_TRUE(limit_of(first, Approach::power, Theory{1, ""}, 1).converged);
  const auto near = sequence(kHalvedSteps, [](double h) { return 1 + std::pow(h, 1.9); });
  // The order 1.9 is within 0.15 of the theory.
  EXPECT_TRUE(limit_of(near, Approach::power, kSecond, 1).converged);
}

TEST(Orders, AValueThatSwingsHasNone) {
  const auto values = sequence(kHalvedSteps, [](double h) {
    return 1 + 0.1 * h * (std::lround(std::log2(h)) % 2 == 0 ? 1 : -1);
  });
  const ExtrapolatedLimit limit = limit_of(values, Approach::power, {}, 1);
  EXPECT_FALSE(limit.converged);
  for (const double order : limit.orders) EXPECT_TRUE(std::isnan(order));
}

TEST(Orders, ALogarithmHasNoLimit) {
  // A point load on a plane continuum has a logarithmic law: the differences between levels are
  // equal (order 0). If no theory is given, the uncertainty covers a level a thousand times finer:
  // ln 1000.
  const auto values = sequence(kHalvedSteps, [](double h) { return 10 - std::log(h); });
  const ExtrapolatedLimit limit = limit_of(values, Approach::power, {}, 10);
  EXPECT_FALSE(limit.converged);
  EXPECT_NEAR(limit.uncertainty, std::log(1000), 1e-9) << limit.sentence;
  const ExtrapolatedLimit none = limit_of(values, Approach::power, Theory{0, "a point load"}, 10);
  EXPECT_FALSE(none.converged);
  EXPECT_FALSE(none.bounded());
  EXPECT_NE(none.sentence.find("a point load"), std::string::npos) << none.sentence;
}

TEST(Orders, DifferencesThatGrowBoundNothing) {
  const auto values = sequence(kHalvedSteps, [](double h) { return 1 / h; });
  EXPECT_FALSE(limit_of(values, Approach::power, {}, 1).bounded());
}

TEST(Orders, WhereNoneIsKnownItIsSaidWhy) {
  const Theory why{std::numeric_limits<double>::quiet_NaN(), "corners are singular"};
  const auto swings = sequence(kHalvedSteps, [](double h) {
    return 1 + 0.1 * h * (std::lround(std::log2(h)) % 2 == 0 ? 1 : -1);
  });
  const ExtrapolatedLimit limit = limit_of(swings, Approach::power, why, 1);
  EXPECT_NE(limit.sentence.find("corners are singular"), std::string::npos) << limit.sentence;
  // If differences decrease, the uncertainty is three times the range of the last three values,
  // 0.95 .. 1.1.
  EXPECT_NEAR(limit.uncertainty, 3 * 0.15, 1e-12);
  // If differences do not decrease, the range is that of the last four values, 1 .. 1.35.
  const std::vector<LevelValue> grow = {{8, 1.5}, {4, 1}, {2, 1.3}, {1, 1.1}, {0.5, 1.35}};
  EXPECT_NEAR(limit_of(grow, Approach::power, why, 1).uncertainty, 3 * 0.35, 1e-12);
  const auto first = sequence(kHalvedSteps, [](double h) { return 1 + h; });
  EXPECT_TRUE(limit_of(first, Approach::power, why, 1).converged);
}

TEST(Orders, TheFloorOfRoundingIsNoOrder) {
  // The term h⁴ starts at 1e-4 and falls below 1e-9 of the value; an alternating error of 1e-11 is
  // added as rounding.
  const std::vector<double> h = {0.1, 0.05, 0.025, 0.0125, 0.00625, 0.003125, 0.0015625};
  int i = 0;
  const auto values =
      sequence(h, [&](double x) { return 1 + std::pow(x, 4) + 1e-11 * (++i % 2 == 0 ? 1 : -1); });
  const ExtrapolatedLimit limit = limit_of(values, Approach::power, Theory{4, ""}, 1);
  EXPECT_TRUE(limit.converged) << limit.sentence;
  EXPECT_NEAR(limit.value, 1, 1e-9);
  EXPECT_TRUE(std::isnan(limit.orders.back()));
  // Equal values on all levels mean that the quantity does not depend on the parameter.
  const auto same = sequence(kHalvedSteps, [](double) { return 5.0; });
  const ExtrapolatedLimit none = limit_of(same, Approach::power, kSecond, 5);
  EXPECT_TRUE(none.converged);
  EXPECT_EQ(none.uncertainty, 0);
}

TEST(Orders, ThreeLevelsCheckNothing) {
  const auto law = [](double h) { return 1 + h * h; };
  EXPECT_FALSE(limit_of(sequence({4, 2, 1}, law), Approach::power, kSecond, 1).converged);
  EXPECT_FALSE(limit_of(sequence({4, 2}, law), Approach::power, kSecond, 1).bounded());
  EXPECT_FALSE(limit_of({}, Approach::power, kSecond, 1).bounded());
  EXPECT_TRUE(limit_of(sequence({4, 2, 1, 0.5}, law), Approach::power, kSecond, 1).converged);
}

TEST(Orders, FastOnesEndAtTheFinestLevel) {
  const auto values = sequence({3, 2, 1.5, 1.2}, [](double h) { return 1 + std::exp(-12 / h); });
  const ExtrapolatedLimit limit = limit_of(values, Approach::fast, {}, 1);
  EXPECT_TRUE(limit.converged);
  EXPECT_EQ(limit.value, values.back().value);
  EXPECT_LT(std::abs(limit.value - 1), limit.uncertainty);
  const auto swings = sequence({3, 2, 1}, [](double h) { return h == 2 ? 1.1 : 1.0; });
  EXPECT_FALSE(limit_of(swings, Approach::fast, {}, 1).converged);
}

}  // namespace
}  // namespace flexmorph::cases
