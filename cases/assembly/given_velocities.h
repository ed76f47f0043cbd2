#pragma once

#include "cases/scene/scene.h"
#include "fem/workspace.h"

namespace flexmorph::cases {

/// Puts an assembled twin into the motion that the case asks for: rigid bodies have the velocities
/// it gives, joints and drives are kept, and of all motions that do both it is the one of least
/// kinetic energy. Given velocities are facts, so that a key that is missing differs from one that
/// says 0.
/// @param x  in: positions that joints have; out: v as well
/// @throws Error (input) with file and line of the body, the velocities and the joints that
///         contradict them; Error (numerical) where joints alone allow no velocity.
void move_as_given(const Scene& scene, const fem::Model& twin, fem::State& x);

}  // namespace flexmorph::cases
