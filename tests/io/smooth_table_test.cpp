// Shows that smooth tables pass through all points, that their derivatives are consistent and
// continuous, that they have the order of splines of degree 5, and that they reproduce polynomials
// of degree 5 exactly.
#include "io/smooth_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <unsupported/Eigen/Splines>

#include "geometry/base.h"
#include "tests/io/scratch.h"
#include "tests/support/dense.h"
#include "tests/support/rates.h"

namespace flexmorph::io {
namespace {

struct Points {
  std::vector<double> t, x;
};

/// Returns f at n + 1 times in [0, 2], moved randomly by up to `uneven` times their distance.
template <class F>
Points sampled(int n, F f, double uneven = 0) {
  std::mt19937 engine(7);
  Points p;
  for (int i = 0; i <= n; ++i) {
    const double draw = 2 * (static_cast<double>(engine()) / 4294967295.0) - 1;
    p.t.push_back(2.0 / n * (i + (i == 0 || i == n ? 0 : uneven * draw)));
    p.x.push_back(f(p.t.back()));
  }
  return p;
}

double wave(double t) { return std::sin(3 * t) + 0.5 * std::exp(-t); }

TEST(SmoothTable, GoesThroughItsPoints) {
  for (const int n : {3, 4, 5, 6, 7, 40, 1000}) {
    const Points p = sampled(n, wave, 0.3);
    const SmoothTable table(p.t, p.x);
    EXPECT_EQ(table.first(), 0);
    EXPECT_EQ(table.last(), p.t.back());
    for (size_t i = 0; i < p.t.size(); ++i)
      EXPECT_NEAR(table(p.t[i]).value, p.x[i], 1e-12) << n << " " << i;
  }
}

TEST(SmoothTable, ReproducesPolynomials) {
  for (const int n : {3, 4, 5, 6, 30}) {
    const int degree = std::min(n, 5);
    const auto f = [&](double t) { return std::pow(t - 0.7, degree) + t; };
    const Points p = sampled(n, f, 0.3);
    const SmoothTable table(p.t, p.x);
    for (double t = 0; t <= 2; t += 0.0625) {
      const Jet x = table(t);
      EXPECT_NEAR(x.value, f(t), 1e-10);
      EXPECT_NEAR(x.rate, degree * std::pow(t - 0.7, degree - 1) + 1, 1e-9);
      EXPECT_NEAR(x.acceleration, degree * (degree - 1) * std::pow(t - 0.7, degree - 2), 1e-7);
    }
  }
}

/// Returns the largest errors of value, rate and acceleration of the table of the wave with
/// distance h.
std::array<double, 3> errors(double h) {
  const Points p = sampled(static_cast<int>(std::lround(2 / h)), wave);
  const SmoothTable table(p.t, p.x);
  std::array<double, 3> out{};
  for (int i = 0; i <= 4000; ++i) {
    const double t = 2.0 * i / 4000;
    const Jet x = table(t);
    out[0] = std::max(out[0], std::abs(x.value - wave(t)));
    out[1] = std::max(out[1], std::abs(x.rate - 3 * std::cos(3 * t) + 0.5 * std::exp(-t)));
    out[2] = std::max(out[2], std::abs(x.acceleration + 9 * std::sin(3 * t) - 0.5 * std::exp(-t)));
  }
  return out;
}

TEST(SmoothTable, ConvergesWithOrderSix) {
  for (size_t k = 0; k < 3; ++k) {
    const auto rate =
        testing::fit_rate({0.05, 0.025, 0.0125}, [&](double h) { return errors(h)[k]; });
    EXPECT_NEAR(rate.order(), 6.0 - static_cast<double>(k), 0.4) << rate.table();
  }
}

// Rates must equal differences of values, and accelerations differences of rates. No derivative may
// jump between the polynomials, which would be visible because differences over a step are small.
TEST(SmoothTable, DerivativesBelongTogether) {
  const Points p = sampled(24, wave, 0.3);
  const SmoothTable table(p.t, p.x);
  const double h = 1e-5;
  for (int i = 1; i < 2000; ++i) {
    const double t = 1e-3 * i;
    const Jet before = table(t - h), x = table(t), after = table(t + h);
    EXPECT_NEAR((after.value - before.value) / (2 * h), x.rate, 1e-8);
    EXPECT_NEAR((after.rate - before.rate) / (2 * h), x.acceleration, 1e-8);
    EXPECT_NEAR(after.acceleration, before.acceleration, 40 * 2 * h);  // its rate is below 30
  }
}

// The expected spline comes from Eigen's B-splines and a dense solution.
TEST(SmoothTable, AgreesWithADenseSolution) {
  using Spline = Eigen::Spline<double, 1, 5>;
  const Points p = sampled(60, wave, 0.45);
  const auto n = static_cast<Eigen::Index>(p.t.size());
  const double length = p.t.back();
  const Spline::KnotVectorType u =
      Eigen::Map<const Eigen::VectorXd>(p.t.data(), n).transpose() / length;
  Spline::KnotVectorType knots;
  Eigen::KnotAveraging(u, 5, knots);
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i + 1 < n; ++i)
    matrix.block(i, Spline::Span(u[i], 5, knots) - 5, 1, 6) =
        Spline::BasisFunctions(u[i], 5, knots).matrix();
  matrix(n - 1, n - 1) = 1;
  const Eigen::VectorXd controls =
      testing::solve(matrix, Eigen::Map<const Eigen::VectorXd>(p.x.data(), n));
  const Spline spline(knots, controls.transpose());
  const SmoothTable table(p.t, p.x);
  for (double t = 0.001; t < 2; t += 0.0073) {
    const auto expected = spline.derivatives(t / length, 2);
    const Jet x = table(t);
    EXPECT_NEAR(x.value, expected(0, 0), 1e-13) << t;
    EXPECT_NEAR(x.rate, expected(0, 1) / length, 1e-11) << t;
    EXPECT_NEAR(x.acceleration, expected(0, 2) / (length * length), 1e-8) << t;
  }
}

// In tables as long as measurements, errors must not grow from one end to the other.
TEST(SmoothTable, LongTablesGoThroughTheirPoints) {
  const auto f = [](double t) { return std::sin(3000 * t); };
  const Points p = sampled(100'000, f, 0.4);
  const SmoothTable table(p.t, p.x);
  double off = 0, between = 0;
  for (size_t i = 0; i + 1 < p.t.size(); ++i) {
    off = std::max(off, std::abs(table(p.t[i]).value - p.x[i]));
    const double t = 0.5 * (p.t[i] + p.t[i + 1]);
    between = std::max(between, std::abs(table(t).value - f(t)));
  }
  EXPECT_LT(off, 1e-14);
  EXPECT_LT(between, 1e-7);  // of order six in 0.06 to 0.1 rad between two points
}

TEST(SmoothTable, RefusesWhatIsNoTable) {
  const auto complaint = [](std::vector<double> t, std::vector<double> x) -> std::string {
    try {
      const SmoothTable table(t, x);
      table(-0.1);
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), Error::Kind::input);
      return e.what();
    }
    return "";
  };
  const double nan = std::nan("");
  EXPECT_TRUE(says(complaint({0, 1, 2}, {0, 1, 2}), "", {"4", "3", "points"}));
  EXPECT_TRUE(says(complaint({0, 1, 2, 3}, {0, 1, 2}), "", {"4 times", "3 values"}));
  // In the first table the distances are negligible relative to the whole; in the others no
  // derivative is representable.
  EXPECT_TRUE(says(complaint({0, 1, 2, 3, 4, 5, 1e308}, {0, 1, 2, 3, 4, 5, 6}), "row 2 ",
                   {"1 s", "0 s", "distance", "1e-11"}));
  EXPECT_TRUE(says(complaint({-1e308, 0, 1, 1e308}, {0, 1, 2, 3}), "", {"span", "finite"}));
  EXPECT_TRUE(says(complaint({0, 1, 2, 3}, {0, 1e308, -1e308, 1e308}), "", {"smooth", "values"}));
  // With a distant last time the spline would have values up to 4e27 between table values up to 2.
  EXPECT_TRUE(
      says(complaint({0, 0.1, 0.2, 0.3, 0.4, 0.5, 9999999999}, {0, 0.2, 0.1, 0.7, 1, 1.5, 2}), "",
           {"smooth", "distances", "differ"}));
  EXPECT_TRUE(says(complaint({0, 1, 1, 3}, {0, 1, 2, 3}), "row 3 ", {"1 s", "1 s", "increase"}));
  EXPECT_TRUE(says(complaint({0, 1, 2, 3}, {0, nan, 2, 3}), "row 2 ", {"time", "value", "finite"}));
  EXPECT_TRUE(says(complaint({0, 1, 2, 3}, {0, 1, 2, 3}), "", {"covers", "0 to 3 s", "t = -0.1"}));
}

}  // namespace
}  // namespace flexmorph::io
