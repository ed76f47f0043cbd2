#include "io/table_noise.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace flexmorph::io {
namespace {

constexpr size_t kMinPoints = 16;
constexpr size_t kWideSpacing = 4;       // [intervals]
constexpr double kMinSignChanges = 0.6;  // independent errors: 1/2 + asin(2/3)/π = 0.73
constexpr double kMinRatio = 4;          // independent errors: 16

/// Returns the accelerations from divided differences between points that are `step` points apart.
std::vector<double> accelerations(std::span<const double> t, std::span<const double> x,
                                  size_t step) {
  std::vector<double> out;
  for (size_t i = step; i + step < t.size(); ++i) {
    const size_t a = i - step, b = i + step;
    const double before = (x[i] - x[a]) / (t[i] - t[a]), after = (x[b] - x[i]) / (t[b] - t[i]);
    out.push_back(2 * (after - before) / (t[b] - t[a]));
  }
  return out;
}

double root_mean_square(const std::vector<double>& all) {
  double sum = 0;
  for (const double each : all) sum += each * each;
  return std::sqrt(sum / static_cast<double>(all.size()));
}

}  // namespace

std::optional<TableNoise> noise_of(std::span<const double> times, std::span<const double> values) {
  if (times.size() < kMinPoints || values.size() != times.size()) return {};
  const std::vector<double> near = accelerations(times, values, 1);
  size_t changes = 0;
  for (size_t i = 1; i < near.size(); ++i) changes += near[i] * near[i - 1] < 0;
  const double size = root_mean_square(near);
  const TableNoise out = {static_cast<double>(changes) / static_cast<double>(near.size() - 1),
                          size / root_mean_square(accelerations(times, values, kWideSpacing))};
  const auto [least, largest] = std::minmax_element(values.begin(), values.end());
  const double span = times.back() - times.front();
  const bool noisy = out.sign_changes > kMinSignChanges && out.ratio > kMinRatio &&
                     size > (*largest - *least) / (span * span);
  return noisy ? std::optional(out) : std::nullopt;
}

}  // namespace flexmorph::io
