#pragma once

#include <vector>

namespace flexmorph::fem {

struct MotionSettings;

/// A time that steps of a motion must land on.
struct Landing {
  double t = 0;
  bool stop = false;  ///< is it to be seen?
  bool kink = false;  ///< may accelerations and forces jump there?
};

/// All of a motion, in order: stops (where steps are equal), kinks between start and end, the end.
/// A kink and what is next to it by less than `near` [s] are one, at the time of the last kink.
std::vector<Landing> landings(const MotionSettings& settings, double near);

/// Where the last step before a kink ends: further from it than times are rounded.
double just_before(double kink);

}  // namespace flexmorph::fem
