#pragma once

#include "fem/force_elements/pair_force_element.h"

namespace flexmorph::fem {

/// A number z(y) of two markers y = (p_a, e_a, p_b, e_b), with its derivatives.
struct PairCoordinate {
  double z = 0;                                          ///< Value z [m] or [rad].
  MarkerPair::Values z_y = MarkerPair::Values::Zero();   ///< Gradient ∂z/∂y.
  MarkerPair::Square z_yy = MarkerPair::Square::Zero();  ///< Second derivatives ∂²z/∂y².
};

/// Returns the coordinate 0 or 1 of d = p_b - p_a along an axis of a: e_a · d or n_a · d [m].
PairCoordinate coordinate_along(const MarkerPair::Values& y, int axis);
/// Returns the distance |p_b - p_a| [m]; its derivatives are set to zero where the points coincide.
PairCoordinate distance_between(const MarkerPair::Values& y);
/// Returns the angle θ_b - θ_a [rad] with the number of whole turns for which it differs by at most
/// 180 degrees from the value `near`.
PairCoordinate angle_between(const MarkerPair::Values& y, double near);

/// A force N(z, ż) that acts against an increase of a coordinate.
struct CoordinateForce {
  /// Elastic component of N, total force N, and its derivatives by z and by ż.
  double elastic = 0, total = 0, by_z = 0, by_rate = 0;
};

/// Adds the force N of a coordinate to the force on the two markers:
///
///   s = N z_y,   s_y = z_y (N_z z_y + N_ż z_yy ẏ)ᵀ + N z_yy,   s_ẏ = N_ż z_y z_yᵀ
void add_along(const PairCoordinate& c, const MarkerPair::Values& rate, const CoordinateForce& n,
               PairForce& out);

}  // namespace flexmorph::fem
