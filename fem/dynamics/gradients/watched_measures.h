#pragma once

#include <span>
#include <vector>

#include "fem/dynamics/gradients/motion_gradient.h"

namespace flexmorph::fem {

/// Values of the measures of a motion at all observed times, and the objectives J formed from them.
class WatchedMeasures {
 public:
  /// Creates an empty record for the objectives.
  explicit WatchedMeasures(std::span<const MotionObjective> objectives);

  /// Records the values of the measures at a step of the motion.
  void see(const MotionStep& step);
  /// Returns true if the objective uses the measure at the observed time with index `at`.
  bool wants(size_t objective, size_t at) const {
    return objectives_[objective].times == MotionObjective::Times::steps || stop_[at];
  }

  /// Value of an objective and its derivatives with respect to the values of the measure.
  struct Mean {
    double value = 0;            ///< Value of the objective J.
    std::vector<double> slopes;  ///< Derivatives ∂J/∂m(t_i) for all observed times.
  };
  /// Returns the value of an objective and its derivatives with respect to the measure.
  /// @param stops  MotionSettings::stops of the motion [s].
  Mean mean(size_t objective, std::span<const double> stops) const;

  /// Returns all observed times [s].
  const std::vector<double>& times() const { return time_; }

 private:
  std::vector<double> weights_of_stops(std::span<const double> stops) const;
  std::vector<double> weights_of_steps() const;

  std::vector<MotionObjective> objectives_;
  std::vector<double> time_;
  std::vector<bool> stop_;
  std::vector<std::vector<double>> values_;  // of the measure of every objective
};

}  // namespace flexmorph::fem
