#pragma once

#include "cases/assembly/build.h"
#include "fem/dynamics/starts/rigid_motion.h"

namespace flexmorph::cases {

/// Sets how the motion of a mechanism starts (fem/README.md, Starts), and the words that say so
/// where the case leaves it to the program.
/// @param rigid      motion of the rigid mechanism; null where the scene is none
/// @param mechanism  receives `motion.start` and `start_words`; all else is set
/// @throws Error (input) where the scene cannot start as the case asks.
void set_start(const Scene& scene, fem::RigidMotion* rigid, Mechanism& mechanism);

}  // namespace flexmorph::cases
