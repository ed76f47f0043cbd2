#pragma once

#include "fem/dynamics/motion.h"

/// Errors that stop a motion, with their messages.
namespace flexmorph::fem {

/// Returns the error that the material has turned inside out at time t [s].
/// @param step   Number of accepted steps.
/// @param ratio  Smallest area ratio |r_m x r_n|.
Error collapsed(double t, int step, double ratio);

/// Returns the error that a motion without drives has gained energy, see EnergyGrowth.
/// @param t           Time [s].
/// @param step        Number of accepted steps.
/// @param defect      Residual of the energy balance [J].
/// @param has_joints  True if the model has constraints.
Error gained_energy(const MotionSettings& settings, double t, int step, double energy_error,
                    const EnergyGain& gain, bool has_joints);

}  // namespace flexmorph::fem
