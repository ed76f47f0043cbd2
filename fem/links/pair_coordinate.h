#pragma once

#include "fem/links/pair_link.h"

namespace flexmorph::fem {

/// A number z(y) of two markers y = (p_a, e_a, p_b, e_b), with its derivatives.
struct PairCoordinate {
  double z = 0;
  MarkerPair::Values z_y = MarkerPair::Values::Zero();
  MarkerPair::Square z_yy = MarkerPair::Square::Zero();
};

/// Coordinate 0 or 1 of p_b - p_a along an axis of a: e_a · d or n_a · d [m].
PairCoordinate coordinate_along(const MarkerPair::Values& y, int axis);
/// |p_b - p_a| [m]; its derivatives are zero where the points meet.
PairCoordinate distance_between(const MarkerPair::Values& y);
/// θ_b - θ_a, counted on from a value that is less than half a turn away [rad].
PairCoordinate angle_between(const MarkerPair::Values& y, double near);

/// A force N(z, ż) against the growth of a coordinate: its elastic part, and derivatives.
struct CoordinateForce {
  double elastic = 0, total = 0, by_z = 0, by_rate = 0;
};

/// Adds it to the force of a link:
///
///   s = N z_y,   s_y = z_y (N_z z_y + N_ż z_yy ẏ)ᵀ + N z_yy,   s_ẏ = N_ż z_y z_yᵀ
void add_along(const PairCoordinate& c, const MarkerPair::Values& rate, const CoordinateForce& n,
               PairForce& out);

}  // namespace flexmorph::fem
