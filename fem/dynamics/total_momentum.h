#pragma once

#include "fem/model/workspace.h"

namespace flexmorph::fem {

/// Momentum of all bodies of a planar model, including the material in their reservoirs.
struct TotalMomentum {
  Vec2 linear{0, 0};  ///< Linear momentum ∫ ṙ dm [kg m/s].
  double angular = 0;  ///< Angular momentum ∫ r × ṙ dm about the origin of the world [kg m²/s].
};

/// Returns the linear and the angular momentum of a planar model. The momentum along a rigid motion
/// is the derivative of the kinetic energy with respect to the speed of this motion. The energy is
/// quadratic in the velocities; therefore a central difference with any step ω is exact,
///
///   L = (T(q̇ + ω w) - T(q̇ - ω w)) / 2ω,     w: all vector unknowns, rotated by 90°.
///
/// @throws Error (input) if a body of the model is not planar.
TotalMomentum total_momentum(Workspace& model, const State& x);

}  // namespace flexmorph::fem
