// Shows that Hermite functions interpolate, reproduce cubics and have the rates that differences in
// time give at a fixed material point while both ends move; that Gauss rules have their degree; and
// that Lagrange weights over a fraction of an element are exact for polynomials.
#include "fem/shapes/shape.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/differences.h"

namespace flexmorph::fem {
namespace {

using Eigen::Vector4d;

Motion left(double t) {
  return {0.3 + 0.1 * std::sin(2 * t), 0.2 * std::cos(2 * t), -0.4 * std::sin(2 * t)};
}
Motion right(double t) { return {0.9 - 0.05 * t * t, -0.1 * t, -0.1}; }

/// Returns polynomials (rows of coefficients) at s.
Vector4d at(const Eigen::Matrix4d& rows, double s) {
  return rows * Vector4d(1, s, s * s, s * s * s);
}

Vector4d values(double t, double x) {
  const Hermite h(left(t), right(t));
  return at(h.value, (x - h.start) / h.length);
}

double cubic(double x) { return 0.7 - 1.3 * x + 0.4 * x * x + 2.1 * x * x * x; }
double cubic_slope(double x) { return -1.3 + 0.8 * x + 6.3 * x * x; }

Vector4d nodal_values(double t) {
  const double a = left(t).value, b = right(t).value;
  return {cubic(a), cubic_slope(a), cubic(b), cubic_slope(b)};
}

TEST(Hermite, InterpolatesValueAndSlopeAtItsEnds) {
  const Hermite h(left(0.4), right(0.4));
  const Eigen::Matrix4d slope = derivative(h.value) / h.length;
  Eigen::Matrix4d ends;
  ends << at(h.value, 0), at(slope, 0), at(h.value, 1), at(slope, 1);
  EXPECT_LT((ends - Eigen::Matrix4d::Identity()).cwiseAbs().maxCoeff(), 1e-14);
}

// Four conditions determine a cubic; therefore only round-off remains.
TEST(Hermite, ReproducesCubics) {
  for (const double x : {0.4, 0.52, 0.77})
    EXPECT_NEAR(values(0.4, x).dot(nodal_values(0.4)), cubic(x), 1e-14);
}

// With differences of order 4 and step 1e-3, truncation h^4 f^(6) / 90 and round-off 30 eps / (12
// h^2) are both near 1e-9 of the second derivative.
TEST(Hermite, RatesAreThoseAtAFixedMaterialPoint) {
  const double t = 0.4;
  const Hermite h(left(t), right(t));
  for (const double x : {0.4, 0.52, 0.77}) {
    const double s = (x - h.start) / h.length;
    const auto moved = [&](double dt) { return values(t + dt, x); };
    EXPECT_LT((at(h.rate, s) - testing::first_difference(moved, 1e-3)).norm(), 1e-10);
    EXPECT_LT((at(h.acceleration, s) - testing::second_difference(moved, 1e-3)).norm(), 2e-8);
    // The rate of the slope: the derivative by X commutes with the time derivative at fixed X.
    const auto slope = [&](double dx) {
      const double at_x = (x + dx - h.start) / h.length;
      return at(h.rate, at_x);
    };
    EXPECT_LT(
        (at(derivative(h.rate), s) / h.length - testing::first_difference(slope, 1e-3)).norm(),
        1e-10);
  }
}

// A field that is fixed in the material has no rate, although the nodes move through it: the change
// of the nodal values and the rate of the shape functions cancel.
TEST(Hermite, MovingEndsDoNotMoveAFixedField) {
  const double t = 0.4;
  const Hermite h(left(t), right(t));
  const Vector4d q = nodal_values(t);
  const auto nodal = [&](double dt) { return nodal_values(t + dt); };
  const Vector4d q_t = testing::first_difference(nodal, 1e-3),
                 q_tt = testing::second_difference(nodal, 1e-3);
  for (const double s : {0.1, 0.5, 0.8}) {
    EXPECT_NEAR(at(h.rate, s).dot(q) + at(h.value, s).dot(q_t), 0, 1e-10);
    EXPECT_NEAR(
        at(h.acceleration, s).dot(q) + 2 * at(h.rate, s).dot(q_t) + at(h.value, s).dot(q_tt), 0,
        1e-8);
  }
}

TEST(Gauss, IsExactToDegreeTwoNMinusOneAndNotFurther) {
  for (int n = 1; n <= 16; ++n) {
    const GaussRule& rule = gauss(n);
    const auto moment = [&](int degree) {
      double sum = 0;
      for (size_t g = 0; g < rule.points.size(); ++g)
        sum += rule.weights[g] * std::pow(rule.points[g], degree);
      return sum;
    };
    for (int d = 0; d < 2 * n; ++d) EXPECT_NEAR(moment(d), 1.0 / (d + 1), 1e-15) << n << " " << d;
    // The error for x^(2n) is (n!)^4 / ((2n + 1) ((2n)!)^2), the remainder of Gauss's rule.
    const double error =
        std::exp(4 * std::lgamma(n + 1.0) - 2 * std::lgamma(2 * n + 1.0)) / (2 * n + 1);
    EXPECT_NEAR(1.0 / (2 * n + 1) - moment(2 * n), error, 1e-15) << n;
  }
  EXPECT_THROW(gauss(0), Error);
  EXPECT_THROW(gauss(17), Error);
}

// Lagrange polynomials through n points reproduce degree n - 1; at Gauss points their values inside
// [0, 1] are below 10, so that only round-off remains.
TEST(LagrangeIntegrals, AreExactForPolynomialsOverParts) {
  for (const int n : {1, 4, 7, 13, 16})
    for (const auto& [lower, upper] :
         {std::pair{0.0, 1.0}, {0.0, 0.031}, {0.27, 0.64}, {0.99, 1.0}}) {
      const VectorXd w = lagrange_integrals(n, lower, upper);
      for (int d = 0; d < n; ++d) {
        double sum = 0;
        for (int g = 0; g < n; ++g)
          sum += w[g] * std::pow(gauss(n).points[static_cast<size_t>(g)], d);
        EXPECT_NEAR(sum, (std::pow(upper, d + 1) - std::pow(lower, d + 1)) / (d + 1), 1e-14)
            << n << " " << d;
      }
    }
}

}  // namespace
}  // namespace flexmorph::fem
