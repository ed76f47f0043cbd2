#pragma once

#include "fem/material_reservoir.h"

namespace flexmorph::fem {

/// Checks the data of a material reservoir.
/// @throws Error (input) see make_reservoir_inertia()
void check(const MaterialReservoir& reservoirs);

/// Returns X 1 + Y J with J the rotation by 90 degrees, which maps u to X u + Y v (2 x 2).
Eigen::Matrix2d arm_of(const Vec2& point);
/// Returns the axis of the outlet in the axes of the body.
Vec2 axis_of(const MaterialReservoir& reservoirs);

/// Returns ∫ρ Nᵀ N of a rigid body in natural coordinates (4 x 4).
/// @param square  ∫ρ |X|², moment of inertia about the point r [kg m²]
Eigen::Matrix4d mass_matrix(double mass, const Vec2& center, double square);
/// Returns ∫ρ Nᵀ D of material that slides along the axis of the outlet (4 x 4); zero for a coil.
Eigen::Matrix4d sliding_matrix(double mass, const Vec2& center,
                               const MaterialReservoir& reservoirs);
/// Returns ∫ρc Nᵀ N dy over the width at a point of the body (4 x 4).
Eigen::Matrix4d mass_across(const MaterialReservoir& reservoirs, const Vec2& middle);

}  // namespace flexmorph::fem
