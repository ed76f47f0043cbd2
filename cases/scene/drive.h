#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "fem/element.h"

/// [[drive]], [trajectory], and what follows drives.
namespace flexmorph::cases {

/// A motion: the name of a drive, or where there is none a constant.
struct Law {
  std::string drive;
  double value = 0;
};

/// A function of time that a case gives a name.
struct Drive {
  std::string name;
  std::string words;  ///< as the case says it: the formula, or where the table comes from
  /// Beyond the run's time it goes on as the parabola of value, rate and acceleration at its end.
  std::function<fem::Motion(double)> motion;
  std::vector<double> kinks;  ///< in (0, end]: first times of other branches of its formula [s]
  std::string jump;           ///< the first jump of value or rate, in words; empty: there is none
  /// Of a coordinate of a curve: where its parameter ends, which takes the place of time. It drives
  /// nothing but `path` joints, and its kinks are no times.
  std::optional<double> until;
  bool from_trajectory = false;  ///< what the trajectory's body needs of it (follow_trajectory())
};

/// The path of a rigid body that drives with from = "trajectory" follow from.
struct Trajectory {
  std::string body;
  Law x, y, angle;  ///< of the body's point and axis
};

}  // namespace flexmorph::cases
