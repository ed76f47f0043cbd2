// Shows that the Taylor test distinguishes correct gradients (order 2) from wrong ones (order 1).

#include "tests/support/gradient_check.h"

#include <gtest/gtest.h>

#include <cmath>

namespace flexmorph::optim::test {
namespace {

const VectorXd kX = Eigen::Vector2d(0.4, -0.7);
const VectorXd kDirection = Eigen::Vector2d(0.6, 0.8);

double smooth(const VectorXd& x) { return std::exp(x[0]) * std::sin(x[1]); }
VectorXd d_smooth(const VectorXd& x) {
  return std::exp(x[0]) * Eigen::Vector2d(std::sin(x[1]), std::cos(x[1]));
}

TEST(TaylorTest, RightGradientsAreOfOrderTwo) {
  const TaylorTest test = taylor_test(smooth, d_smooth(kX), kX, kDirection, 1e-1, 4);
  // The next term of the expansion is t³/6; it changes the order by less than 0.05 for t < 0.1.
  EXPECT_NEAR(test.order, 2, 0.05) << test.table();
  EXPECT_GE(test.decades, 3) << test.table();
  EXPECT_EQ(test.steps.size(), 9u);
  EXPECT_EQ(test.orders.size(), 8u);
  EXPECT_DOUBLE_EQ(test.steps[0], 1e-1);
  EXPECT_NEAR(test.steps[8], 1e-5, 1e-17);
}

TEST(TaylorTest, WrongGradientsAreOfOrderOne) {
  const VectorXd wrong = 1.001 * d_smooth(kX);
  // An error of 1e-3 of the derivative dominates as soon as t is much smaller.
  EXPECT_NEAR(taylor_test(smooth, wrong, kX, kDirection, 1e-5, 3).order, 1, 0.05);
}

// The remainder is exactly t², until round-off ends the fit.
TEST(TaylorTest, RoundOffIsLeftOut) {
  const auto square = [](const VectorXd& x) { return 1 + x.squaredNorm(); };
  const VectorXd unit = Eigen::Vector2d(1, 0);
  const TaylorTest test = taylor_test(square, 2 * kX, kX, unit, 1, 12);
  EXPECT_NEAR(test.remainders[0], 1, 1e-14);
  // the last fitted points contain 10 % round-off
  EXPECT_NEAR(test.order, 2, 0.02) << test.table();
  EXPECT_LT(test.decades, 9) << test.table();  // √1e-15 of 1: at most 7.5 decades remain
  EXPECT_NE(test.table().find("order"), std::string::npos);
}

TEST(TaylorTest, LinearFunctionsHaveNoRemainder) {
  const auto linear = [](const VectorXd& x) { return 3 * x[0] - x[1]; };
  const TaylorTest test = taylor_test(linear, Eigen::Vector2d(3, -1), kX, kDirection, 1e-1, 3);
  EXPECT_TRUE(std::isinf(test.order)) << test.table();
}

TEST(TaylorTest, BadInputIsRefused) {
  EXPECT_THROW(taylor_test(smooth, VectorXd::Zero(3), kX, kDirection, 1, 3), Error);
  EXPECT_THROW(taylor_test(smooth, d_smooth(kX), kX, kDirection, 0, 3), Error);
  const auto nan = [](const VectorXd&) { return std::nan(""); };
  EXPECT_THROW(taylor_test(nan, d_smooth(kX), kX, kDirection, 1, 3), Error);
}

}  // namespace
}  // namespace flexmorph::optim::test
