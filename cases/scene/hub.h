#pragma once

#include <array>
#include <string>

#include "cases/scene/drive.h"

/// The hubs of a case: [[hub]].
namespace flexmorph::cases {

/// A hub: a rigid frame with prescribed motion that carries a body. It turns about its origin at a
/// constant rate, or drives prescribe its angle and its position.
struct Hub {
  std::string name;             ///< Name by which joints refer to the hub.
  Vec2 position{0, 0};          ///< Position of the origin at the start [m].
  double angle = 0;             ///< Angle of the first axis at the start [rad].
  double angular_velocity = 0;  ///< Constant angular velocity [rad/s]; 0 if a drive turns the hub.
  Law turn;                     ///< Drive of the angle [rad], if there is one.
  std::array<Law, 2> path;      ///< Drives of both coordinates of the position [m], or none.
};

}  // namespace flexmorph::cases
