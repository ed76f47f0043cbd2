#include "cases/study/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/base.h"

namespace flexmorph::cases {

double median(std::vector<double> values) {
  if (values.empty()) throw Error::input("median: there are no values");
  std::sort(values.begin(), values.end());
  const size_t n = values.size();
  return 0.5 * (values[(n - 1) / 2] + values[n / 2]);
}

bool distinguishable(const std::vector<double>& a, const std::vector<double>& b) {
  const auto within = [](double value, const std::vector<double>& range) {
    const auto [least, most] = std::minmax_element(range.begin(), range.end());
    return value >= *least && value <= *most;
  };
  return !within(median(a), b) && !within(median(b), a);
}

int peaks(std::span<const double> values, std::span<const int> stage, double share) {
  constexpr double kUndefined = std::numeric_limits<double>::infinity();
  int count = 0;
  bool rising = false;
  // Smallest value of the stage, smallest value since the last peak, largest value of the last
  // rise.
  double best = kUndefined, low = kUndefined, top = 0;
  for (size_t i = 0; i < values.size(); ++i) {
    if (i > 0 && stage[i] != stage[i - 1]) {
      rising = false;
      best = low = kUndefined;
    }
    const double value = values[i];
    if (!std::isfinite(value)) continue;
    best = std::min(best, value);
    if (!rising) {
      low = std::min(low, value);
      rising = value - low > share * best;
      top = value;
      continue;
    }
    top = std::max(top, value);
    if (top - value > share * best) {
      ++count;
      rising = false;
      low = value;
    }
  }
  return count;
}

std::vector<double> best_so_far(std::span<const double> values, std::span<const double> violation,
                                std::span<const int> stage, double feasibility) {
  std::vector<double> out;
  double best = std::numeric_limits<double>::quiet_NaN();
  for (size_t i = 0; i < values.size(); ++i) {
    if (i > 0 && stage[i] != stage[i - 1]) best = std::numeric_limits<double>::quiet_NaN();
    const bool usable = violation[i] <= feasibility && std::isfinite(values[i]);
    if (usable && !(best <= values[i])) best = values[i];
    out.push_back(best);
  }
  return out;
}

std::vector<std::vector<double>> data_profile(std::span<const std::vector<SolveHistory>> runs,
                                              double tolerance) {
  const size_t n_problems = runs.empty() ? 0 : runs.front().size();
  std::vector<std::vector<double>> out(runs.size());
  for (size_t p = 0; p < n_problems; ++p) {
    double best = std::numeric_limits<double>::infinity();
    for (const auto& solver : runs)
      for (const double value : solver[p].values) best = std::min(best, value);
    for (size_t s = 0; s < runs.size(); ++s) {
      const SolveHistory& progress = runs[s][p];
      for (size_t i = 0; i < progress.values.size(); ++i)
        if (progress.values[i] <= best * (1 + tolerance)) {
          out[s].push_back(progress.solves[i]);
          break;
        }
    }
  }
  for (auto& solves : out) std::sort(solves.begin(), solves.end());
  return out;
}

}  // namespace flexmorph::cases
