#pragma once

#include <limits>

#include "fem/force_element.h"

namespace flexmorph::fem {

/// Data of a stop: a coordinate z of two markers is free between two limits, and beyond them a
/// force pushes it back. With δ the displacement beyond a limit and w the width of the transition,
///
///   N = max(0, k δ²/(2w) + c (δ/w) δ̇)     for 0 < δ < w
///   N = max(0, k (δ - w/2) + c δ̇)         for δ >= w,   no force for δ <= 0
///
/// Therefore the stop never pulls, and w > 0 makes N continuously differentiable at the start of
/// the contact. The energy is the energy of the elastic term. In a damped stop with w = 0 the force
/// jumps to c δ̇ when the contact begins.
struct StopData {
  /// Coordinate that the stop limits.
  enum class Coordinate {
    along,     ///< Position e_a · (p_b - p_a) along axis 1 of a [m].
    distance,  ///< Distance |p_b - p_a| [m], for a rope or a bumper.
    angle      ///< Angle θ_b - θ_a with counted whole turns [rad].
  } coordinate = Coordinate::along;
  /// Lower limit of the coordinate [m] or [rad].
  double least = -std::numeric_limits<double>::infinity();
  /// Upper limit of the coordinate [m] or [rad].
  double most = std::numeric_limits<double>::infinity();
  double stiffness = 0;  ///< Stiffness k [N/m] or [N m/rad].
  double damping = 0;    ///< Damping coefficient c [N s/m] or [N m s/rad].
  double onset = 0;      ///< Width w of the transition [m] or [rad].

  /// Angle near which θ_b - θ_a lies before the first step [rad]; 0 if absent.
  std::optional<double> start_angle{};
};

/// Creates a stop between two markers; it has no mean force.
/// @throws Error (input) unless k > 0, c, w >= 0 and finite, least < most of which one is finite;
/// at bind() see Marker::bind(); (numerical) where points coincide that have a distance limit.
std::unique_ptr<ForceElement> make_stop(std::string name, MarkerLocation a, MarkerLocation b,
                                        const StopData& stop);

}  // namespace flexmorph::fem
