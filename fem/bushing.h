#pragma once

#include "fem/force_element.h"

namespace flexmorph::fem {

/// Data of a bushing: linear springs and dampers along both axes of a, and between the axes of a
/// and b:
///
///   N_i = k_i d_i + c_i ḋ_i,   d = (e_a · (p_b - p_a), n_a · (p_b - p_a))
///   M = k φ + c φ̇,             φ = θ_b - θ_a - φ₀
///
/// with n_a = e_a turned by +90 degrees. Whole turns of φ are counted as in a torsion spring. The
/// forces act at the point of b, on both bodies, so that the moments are in equilibrium.
struct BushingData {
  /// Stiffness [N/m] and damping [N s/m], each along axis 1 of a and across it.
  Vec2 stiffness{0, 0}, damping{0, 0};
  /// Torsional stiffness [N m/rad] and torsional damping [N m s/rad].
  double torsion_stiffness = 0, torsion_damping = 0;
  double rest_angle = 0;  ///< Angle φ₀ of the unloaded bushing [rad].

  /// Angle θ_b - θ_a near the initial state, see TorsionSpringData::start_angle [rad].
  std::optional<double> start_angle{};
};

/// Creates a bushing between two markers; it has no mean force. b may be a point of a plate if
/// there is neither torsional stiffness nor torsional damping, because a point of a plate has no
/// axis.
/// @throws Error (input) for a number that is negative or not finite, and where all are zero; at
/// bind() see Marker::bind().
std::unique_ptr<ForceElement> make_bushing(std::string name, MarkerLocation a, MarkerLocation b,
                                           const BushingData& bushing);

}  // namespace flexmorph::fem
