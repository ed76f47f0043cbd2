// Shows that long formulas have the right derivatives and a limited number of operations.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "io/case_files/formula.h"

namespace flexmorph::io {
namespace {

// Each function, added to a long product, must have the derivatives of the function alone.
TEST(Formula, LongFormulasHaveTheSameDerivatives) {
  std::string product = "cos(t)";
  for (int i = 1; i < 40; ++i) product += "*cos(t + 0.0" + std::to_string(i) + ")";
  const Formula alone(product);
  for (const std::string text : {"sin(2*t)",      "cos(t^2)",
                                 "tan(t)",        "asin(t/2)",
                                 "acos(t/2)",     "atan(3*t)",
                                 "sinh(t)",       "cosh(2*t)",
                                 "tanh(3*t)",     "exp(-t^2)",
                                 "log(1 + t)",    "sqrt(1 + t^3)",
                                 "abs(t - 2)",    "atan2(1 + t^2, 2 - t)",
                                 "(1 + t)^7",     "(1 + t)^(-2)",
                                 "(1 + t)^2.3",   "(1 + t)^(1.5)",
                                 "(1 + t)^(t^2)", "2^t",
                                 "1/(1 + t)",     "3*t + 4"}) {
    const Formula f(text), sum(product + " + " + text);
    for (const double t : {0.1, 0.4, 0.9}) {
      const Jet x = f(t), y = sum(t), z = alone(t);
      const double size = 1 + std::abs(x.acceleration) + std::abs(z.acceleration);
      EXPECT_NEAR(y.value - z.value, x.value, 1e-14 * size) << text;
      EXPECT_NEAR(y.rate - z.rate, x.rate, 1e-13 * size) << text;
      EXPECT_NEAR(y.acceleration - z.acceleration, x.acceleration, 1e-12 * size) << text;
    }
  }
}

// For P = Π (1 + t/k): P'/P = Σ 1/(t + k) = s, P"/P = s² - Σ 1/(t + k)². The number of operations
// must be proportional to the number of factors, not to its third power.
TEST(Formula, LongProductsHaveTheirDerivatives) {
  std::string text = "1";
  for (int k = 100; k < 400; ++k) text += "*(1 + t/" + std::to_string(k) + ".0)";
  const Formula product(text);
  EXPECT_LT(product.n_operations(), 300 * 15);
  for (const double t : {0.0, 0.5, 2.0}) {
    double value = 1, sum = 0, squares = 0;
    for (int k = 100; k < 400; ++k) {
      value *= 1 + t / k;
      sum += 1 / (t + k);
      squares += 1 / ((t + k) * (t + k));
    }
    const Jet x = product(t);
    EXPECT_NEAR(x.value, value, 1e-13 * value);
    EXPECT_NEAR(x.rate, value * sum, 1e-13 * value);
    EXPECT_NEAR(x.acceleration, value * (sum * sum - squares), 1e-12 * value);
  }
}

}  // namespace
}  // namespace flexmorph::io
