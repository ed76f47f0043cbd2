#pragma once

#include <span>
#include <vector>

#include "fem/dynamics/gradients/motion_gradient.h"

namespace flexmorph::fem {

/// The measures of a motion at all times that were seen, and what J makes of them.
class WatchedMeasures {
 public:
  explicit WatchedMeasures(std::span<const MotionObjective> objectives);

  void see(const MotionStep& step);
  /// Is the motion looked at there?
  bool wants(size_t objective, size_t at) const {
    return objectives_[objective].times == MotionObjective::Times::steps || stop_[at];
  }

  struct Mean {
    double value = 0;            ///< J
    std::vector<double> slopes;  ///< ∂J/∂m(t_i) of every time
  };
  /// @param stops  of the motion's settings [s]
  Mean mean(size_t objective, std::span<const double> stops) const;

  const std::vector<double>& times() const { return time_; }  ///< [s]

 private:
  std::vector<double> weights_of_stops(std::span<const double> stops) const;
  std::vector<double> weights_of_steps() const;

  std::vector<MotionObjective> objectives_;
  std::vector<double> time_;
  std::vector<bool> stop_;
  std::vector<std::vector<double>> values_;  // of every objective
};

}  // namespace flexmorph::fem
