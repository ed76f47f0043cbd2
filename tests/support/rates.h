#pragma once

#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

/// Orders of convergence.
namespace flexmorph::testing {

struct Rate {
  std::vector<double> step, error;

  /// Returns the slope of log(error) against log(step) by least squares.
  double order() const {
    double sx = 0, sy = 0, sxx = 0, sxy = 0;
    const auto n = static_cast<double>(step.size());
    for (size_t i = 0; i < step.size(); ++i) {
      const double x = std::log(step[i]), y = std::log(error[i]);
      sx += x;
      sy += y;
      sxx += x * x;
      sxy += x * y;
    }
    return (n * sxy - sx * sy) / (n * sxx - sx * sx);
  }

  std::string table() const {
    std::string out;
    for (size_t i = 0; i < step.size(); ++i) {
      char line[80];
      std::snprintf(line, sizeof line, "  h = %.3e  error = %.4e", step[i], error[i]);
      out += line;
      if (i > 0) {
        const double order = std::log(error[i - 1] / error[i]) / std::log(step[i - 1] / step[i]);
        std::snprintf(line, sizeof line, "  order %.2f", order);
        out += line;
      }
      out += '\n';
    }
    return out;
  }
};

inline Rate fit_rate(const std::vector<double>& steps,
                     const std::function<double(double)>& error_at) {
  Rate rate;
  for (const double h : steps) {
    rate.step.push_back(h);
    rate.error.push_back(error_at(h));
  }
  return rate;
}

}  // namespace flexmorph::testing
