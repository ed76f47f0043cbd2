#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "geometry/base.h"
#include "tests/support/rates.h"

namespace flexmorph::optim {

/// Remainders of a first-order Taylor expansion over a refinement series of steps.
struct TaylorTest {
  std::vector<double> steps;       ///< Step sizes t, largest first, two per decade.
  std::vector<double> remainders;  ///< Remainders |f(x + t d) - f(x) - t df·d|.
  /// Observed orders between neighbouring steps; one entry less than steps.
  std::vector<double> orders;
  /// Slope of log(remainder) against log(t) by least squares, over the steps whose remainder is
  /// larger than round-off; infinite if there are fewer than two (f is linear along d).
  double order = 0;
  double decades = 0;  ///< Decades of t that the fit covers.

  std::string table() const;  ///< Returns a table of t, remainder and order with one line per step.
};

inline std::string TaylorTest::table() const {
  std::string text = "        step    remainder  order\n";
  char line[96];
  for (size_t k = 0; k < steps.size(); ++k) {
    std::snprintf(line, sizeof line, "%12.4e %12.4e", steps[k], remainders[k]);
    text += line;
    if (k > 0) {
      std::snprintf(line, sizeof line, " %6.3f", orders[k - 1]);
      text += line;
    }
    text += "\n";
  }
  std::snprintf(line, sizeof line, "order %.4f over %.1f decades\n", order, decades);
  return text + line;
}

/// Returns the remainders of f along a direction; their order is 2 for the correct gradient of a
/// smooth function and 1 for a wrong gradient.
///
/// @param df         gradient of f at x (n)
/// @param direction  d (n)
/// @param decades    range of the steps below largest_step
/// @param noise      relative round-off of f, in units of |f|; remainders below ten times it are
///                   left out of the fit
/// @throws Error (input) for vectors of different lengths or steps that are not positive,
///         Error (numerical) when f is not finite.
inline TaylorTest taylor_test(const std::function<double(const VectorXd&)>& f, const VectorXd& df,
                              const VectorXd& x, const VectorXd& direction, double largest_step,
                              int decades, double noise = 1e-15) {
  if (df.size() != x.size() || direction.size() != x.size()) {
    throw Error::input("taylor_test: x, gradient and direction have the same length");
  }
  if (!(largest_step > 0) || decades < 1) {
    throw Error::input("taylor_test: a positive step and at least one decade");
  }
  const auto value = [&](const VectorXd& at) {
    const double v = f(at);
    if (!std::isfinite(v)) throw Error::numerical("taylor_test: the function is not finite");
    return v;
  };
  const double f0 = value(x);
  const double slope = df.dot(direction);
  TaylorTest test;
  std::vector<double> fit_t, fit_r;
  bool above_noise = true;
  for (int k = 0; k <= 2 * decades; ++k) {
    const double t = largest_step * std::pow(10.0, -0.5 * k);
    const double ft = value(x + t * direction);
    const double remainder = std::abs(ft - f0 - t * slope);
    test.steps.push_back(t);
    test.remainders.push_back(remainder);
    above_noise = above_noise && remainder > 10 * noise * std::max(std::abs(f0), std::abs(ft));
    if (!above_noise) continue;
    fit_t.push_back(t);
    fit_r.push_back(remainder);
  }
  for (size_t k = 0; k + 1 < test.steps.size(); ++k) {
    const double ratio = test.remainders[k] / test.remainders[k + 1];
    test.orders.push_back(test.remainders[k + 1] == 0
                              ? std::numeric_limits<double>::infinity()
                              : std::log(ratio) / std::log(test.steps[k] / test.steps[k + 1]));
  }
  test.order = std::numeric_limits<double>::infinity();
  if (fit_t.size() >= 2) {
    test.order = testing::Rate{fit_t, fit_r}.order();
    test.decades = std::log10(fit_t.front() / fit_t.back());
  }
  return test;
}

}  // namespace flexmorph::optim
