#include "fem/dynamics/gradients/watched_measures.h"

#include <algorithm>
#include <cmath>

namespace flexmorph::fem {

WatchedMeasures::WatchedMeasures(std::span<const MotionObjective> objectives)
    : objectives_(objectives.begin(), objectives.end()), values_(objectives.size()) {}

void WatchedMeasures::see(const MotionStep& step) {
  time_.push_back(step.x.t);
  stop_.push_back(step.stop);
  for (size_t k = 0; k < objectives_.size(); ++k)
    values_[k].push_back(
        wants(k, time_.size() - 1) ? objectives_[k].measure->value(step.model, step.x) : 0);
}

WatchedMeasures::Mean WatchedMeasures::mean(size_t objective, std::span<const double> stops) const {
  const MotionObjective& o = objectives_[objective];
  const std::vector<double> w =
      o.times == MotionObjective::Times::stops ? weights_of_stops(stops) : weights_of_steps();
  Mean out;
  out.slopes.assign(w.size(), 0);
  const std::vector<double>& m = values_[objective];
  // Values are divided by the largest one, so that powers neither underflow nor overflow.
  double largest = 0, sum = 0;
  for (size_t i = 0; i < m.size(); ++i) largest = std::max(largest, w[i] > 0 ? std::abs(m[i]) : 0);
  if (o.exponent == 1 || largest == 0) {
    for (size_t i = 0; i < m.size(); ++i) out.value += w[i] * m[i];
    if (o.exponent == 1) out.slopes = w;
    return out;
  }
  for (size_t i = 0; i < m.size(); ++i) sum += w[i] * std::pow(m[i] / largest, o.exponent);
  out.value = largest * std::pow(sum, 1 / o.exponent);
  for (size_t i = 0; i < m.size(); ++i)
    out.slopes[i] = w[i] * std::pow(m[i] / out.value, o.exponent - 1);
  return out;
}

/// The motion marks its end as a stop in any case; here it counts only if it is one of `stops`.
std::vector<double> WatchedMeasures::weights_of_stops(std::span<const double> stops) const {
  std::vector<double> out(time_.size(), 0);
  double n = 0;
  for (size_t i = 0; i < out.size(); ++i) {
    const auto near = [&](double t) { return std::abs(t - time_[i]) < 1e-9 * time_.back(); };
    if (stop_[i] && std::any_of(stops.begin(), stops.end(), near)) out[i] = 1;
    n += out[i];
  }
  for (double& w : out) w /= std::max(n, 1.0);
  return out;
}

std::vector<double> WatchedMeasures::weights_of_steps() const {
  std::vector<double> out(time_.size(), 0);
  const double whole = time_.back() - time_.front();
  for (size_t i = 1; i < out.size(); ++i) {
    const double half = 0.5 * (time_[i] - time_[i - 1]) / whole;
    out[i - 1] += half;
    out[i] += half;
  }
  return out;
}

}  // namespace flexmorph::fem
