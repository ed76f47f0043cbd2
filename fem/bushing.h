#pragma once

#include "fem/link.h"

namespace flexmorph::fem {

/// Linear springs and dampers along both axes of a, and between the axes of a and b:
///
///   N_i = k_i d_i + c_i ḋ_i,   d = (e_a · (p_b - p_a), n_a · (p_b - p_a)),   n_a = e_a turned by
///   90° M = k φ + c φ̇,             φ = θ_b - θ_a - φ₀, whole turns counted as in a torsion spring
///
/// Forces act on the point of b; on a they act there too, so that its moment balances.
struct BushingData {
  Vec2 stiffness{0, 0}, damping{0, 0};                ///< along and across [N/m], [N s/m]
  double torsion_stiffness = 0, torsion_damping = 0;  ///< [N m/rad], [N m s/rad]
  double rest_angle = 0;                              ///< φ₀ [rad]
  std::optional<double> start_angle{};                ///< as TorsionSpringData's
};

/// b may be a point of a plate where nothing is torsional: it has no axis. No mean force.
/// @throws Error (input) for a number that is negative or not finite, and where all are zero; at
///         bind() see Marker::bind().
std::unique_ptr<Link> make_bushing(std::string name, MarkerPlace a, MarkerPlace b,
                                   const BushingData& bushing);

}  // namespace flexmorph::fem
