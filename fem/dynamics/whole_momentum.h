#pragma once

#include "fem/model/workspace.h"

namespace flexmorph::fem {

/// Momentum of all bodies of a model in the plane, material that they store included.
struct WholeMomentum {
  Vec2 linear{0, 0};   ///< ∫ ṙ dm [kg m/s]
  double angular = 0;  ///< ∫ r × ṙ dm, about the origin of the world [kg m²/s]
};

/// Momentum along a rigid motion is the derivative of the kinetic energy by its speed; the energy
/// is quadratic in the velocities, so that a central difference has it exactly:
///
///   L = (T(q̇ + ω w) - T(q̇ - ω w)) / 2ω,     w of all vector unknowns: themselves, turned by 90°
///
/// @throws Error (input) for a model in space
WholeMomentum whole_momentum(Workspace& model, const State& x);

}  // namespace flexmorph::fem
