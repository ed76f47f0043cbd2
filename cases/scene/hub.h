#pragma once

#include <array>
#include <string>

#include "cases/scene/drive.h"

/// [[hub]].
namespace flexmorph::cases {

/// A driven hub: turns about its position at a constant rate, or as drives say.
struct Hub {
  std::string name;
  Vec2 position{0, 0};          ///< at the start [m]
  double angle = 0;             ///< at the start [rad]
  double angular_velocity = 0;  ///< [rad/s], 0 where a drive turns the hub
  Law turn;                     ///< the drive of the angle, if any
  std::array<Law, 2> path;      ///< the drives of the position, both or none
};

}  // namespace flexmorph::cases
