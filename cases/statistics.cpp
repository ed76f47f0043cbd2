#include "cases/statistics.h"

#include <algorithm>
#include <limits>

#include "geometry/base.h"

namespace flexmorph::cases {

double median(std::vector<double> values) {
  if (values.empty()) throw Error::input("median: there are no values");
  std::sort(values.begin(), values.end());
  const size_t n = values.size();
  return 0.5 * (values[(n - 1) / 2] + values[n / 2]);
}

int peaks(std::span<const double> values, std::span<const double> band, double share) {
  int count = 0;
  bool rising = false;
  double low = std::numeric_limits<double>::infinity(), top = 0;
  for (size_t i = 0; i < values.size(); ++i) {
    if (i > 0 && band[i] != band[i - 1]) {
      rising = false;
      low = std::numeric_limits<double>::infinity();
    }
    const double value = values[i];
    if (!rising) {
      low = std::min(low, value);
      rising = value > low * (1 + share);
      top = value;
      continue;
    }
    top = std::max(top, value);
    if (value * (1 + share) < top) {
      ++count;
      rising = false;
      low = value;
    }
  }
  return count;
}

std::vector<std::vector<double>> data_profile(std::span<const std::vector<Progress>> runs,
                                              double tolerance) {
  const size_t n_problems = runs.empty() ? 0 : runs.front().size();
  std::vector<std::vector<double>> out(runs.size());
  for (size_t p = 0; p < n_problems; ++p) {
    double best = std::numeric_limits<double>::infinity();
    for (const auto& solver : runs)
      for (const double value : solver[p].values) best = std::min(best, value);
    for (size_t s = 0; s < runs.size(); ++s) {
      const Progress& progress = runs[s][p];
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
