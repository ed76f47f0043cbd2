#pragma once

#include <functional>

#include "fem/shapes/shape.h"

namespace flexmorph::fem {

/// Volume over which the energy density of a body with a temperature change is integrated, relative
/// to the reference volume; s = 1 + α ΔT.
enum class ThermalVolume {
  reference,    ///< Factor 1, as printed in T.
  grown_plane,  ///< Factor s²: lengths in the plane grow, the thickness does not.
  grown         ///< Factor s³: all lengths grow.
};

/// Uniform temperature of one body. Without constraints the body is s = 1 + α ΔT(t) times as large
/// in all directions.
struct Heat {
  double expansion = 0;  ///< Coefficient of thermal expansion α [1/K].

  /// Temperature ΔT(t) above the unstrained state [K].
  std::function<Motion(double t)> temperature;
  ThermalVolume volume = ThermalVolume::grown;  ///< Volume over which the energy is integrated.

  /// Returns the thermal stretch s with its first and second time derivative [-], [1/s], [1/s²].
  Motion stretch(double t) const {
    const Motion rise = temperature(t);
    return {1 + expansion * rise.value, expansion * rise.rate, expansion * rise.acceleration};
  }
  /// Returns the exponent p of the volume ratio sᵖ.
  int volume_exponent() const {
    return volume == ThermalVolume::grown ? 3 : volume == ThermalVolume::grown_plane ? 2 : 0;
  }
};

}  // namespace flexmorph::fem
