#pragma once

#include "cases/assembly/build.h"
#include "fem/dynamics/starts/rigid_motion.h"

namespace flexmorph::cases {

/// Sets the start of the motion of a mechanism (fem/README.md, Starts), and a text about it if the
/// program chooses the start.
/// @param rigid      motion of the rigid mechanism; null where the scene is no mechanism
/// @param mechanism  receives `motion.start` and `start_text`; all other members are set already
/// @throws Error (input) where the scene cannot start as the case asks.
void set_start(const Scene& scene, fem::RigidMotion* rigid, Mechanism& mechanism);

}  // namespace flexmorph::cases
