#pragma once

#include <limits>

#include "fem/link.h"

namespace flexmorph::fem {

/// A coordinate z of two places that may move freely between two limits, and is pushed back beyond
/// them. With δ the way beyond a limit and w the width of the onset,
///
///   N = max(0, k δ²/(2w) + c (δ/w) δ̇)     for 0 < δ < w
///   N = max(0, k (δ - w/2) + c δ̇)         for δ >= w,   nothing for δ <= 0
///
/// so it never pulls, and w > 0 makes N continuously differentiable where it begins. The energy is
/// that of the elastic part. A damped stop (w = 0) jumps to c δ̇ where it is hit.
struct StopData {
  enum class Coordinate {
    along,     ///< e_a · (p_b - p_a), along axis 1 of a [m]
    distance,  ///< |p_b - p_a|: a rope, a bumper [m]
    angle      ///< θ_b - θ_a, whole turns counted [rad]
  } coordinate = Coordinate::along;
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
  double stiffness = 0;                 ///< k [N/m] or [N m/rad]
  double damping = 0;                   ///< c [N s/m] or [N m s/rad]
  double onset = 0;                     ///< w [m] or [rad]
  std::optional<double> start_angle{};  ///< as TorsionSpringData's, next to which else 0 is taken
};

/// No mean force.
/// @throws Error (input) unless k > 0, c, w >= 0 and finite, least < most of which one is finite;
///         at bind() see Marker::bind(); (numerical) where points meet that are to be kept apart.
std::unique_ptr<Link> make_stop(std::string name, MarkerPlace a, MarkerPlace b,
                                const StopData& stop);

}  // namespace flexmorph::fem
