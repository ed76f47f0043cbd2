#pragma once

#include <functional>

#include "fem/shapes/shape.h"

namespace flexmorph::fem {

/// What the energy density of a hot body is integrated over, as parts of the reference volume;
/// s = 1 + α ΔT.
enum class ThermalVolume {
  reference,    ///< 1, as the paper prints it
  grown_plane,  ///< s²: lengths in the plane grow, the third dimension does not
  grown         ///< s³
};

/// Uniform heat of one body: free, it is s = 1 + α ΔT(t) times as large in all directions.
struct Heat {
  double expansion = 0;                         ///< α [1/K]
  std::function<Motion(double t)> temperature;  ///< ΔT above the unstrained state [K]
  ThermalVolume volume = ThermalVolume::grown;

  /// s and its derivatives by time [-], [1/s], [1/s²].
  Motion stretch(double t) const {
    const Motion rise = temperature(t);
    return {1 + expansion * rise.value, expansion * rise.rate, expansion * rise.acceleration};
  }
  /// Exponent p of the volume sᵖ.
  int volume_exponent() const {
    return volume == ThermalVolume::grown ? 3 : volume == ThermalVolume::grown_plane ? 2 : 0;
  }
};

}  // namespace flexmorph::fem
