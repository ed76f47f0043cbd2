#pragma once

#include "fem/dynamics/motion.h"

/// Why a motion is stopped, in words.
namespace flexmorph::fem {

/// The material has turned inside out.
/// @param ratio  smallest |r_m x r_n|
Error collapsed(double t, int step, double ratio);

/// A motion that nothing drives has gained energy, see EnergyGrowth.
/// @param defect  of the balance [J]
Error gained_energy(const MotionSettings& settings, double t, int step, double defect,
                    const EnergyGain& gain, bool has_joints);

}  // namespace flexmorph::fem
