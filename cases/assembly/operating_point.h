#pragma once

#include <string>
#include <vector>

#include "cases/assembly/prepared_case.h"
#include "fem/solve/natural_modes.h"

namespace flexmorph::cases {

/// The state of a mechanism at one time about which small motions are considered. Drives,
/// material flow and temperatures are held at their values of this time.
struct OperatingPoint {
  fem::Workspace model;               ///< Model of the mechanism with its mesh of this time.
  fem::State x;                       ///< Equilibrium with its multipliers.
  std::vector<fem::Turning> turning;  ///< Rotation of every body of the model.
  std::string words;                  ///< Text about the equilibrium.
};

/// Returns true if drives determine the motion of a scene at a time [s]: they leave no degree of
/// freedom of the rigid mechanism and no material line free, and can move the rigid mechanism to
/// its position of this time.
bool drives_determine_motion(const PreparedCase& prepared, double time);

/// Finds the operating point of a scene.
///
/// Where drives determine the whole motion, the operating point is the steady equilibrium under
/// the inertia forces of this motion, with its angular velocities and with the flow of material.
/// Otherwise it is the equilibrium at rest at the positions of the drives, which is followed from
/// the start of the motion to the given time. The operating point of a [static] analysis is its
/// equilibrium at a load factor, and that of a plate with [domain] is the plate without loads.
///
/// @param time     time [s], or load factor of a [static] analysis; 0 for a plate with [domain]
/// @param stopped  true: drives and flow stand still at their positions of this time
/// @throws Error (input) for a time outside of the motion, or a plate without a density; Error
/// (numerical) naming the time when
///         no equilibrium is found
OperatingPoint operating_point(const PreparedCase& prepared, double time, bool stopped);

}  // namespace flexmorph::cases
