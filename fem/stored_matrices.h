#pragma once

#include "fem/stored.h"

namespace flexmorph::fem {

/// @throws Error (input) see make_stored_inertia()
void check(const StoredMaterial& stored);

/// X 1 + Y J, J the quarter turn: takes u to X u + Y v.
Eigen::Matrix2d arm_of(const Vec2& point);
/// The outlet's axis in the axes of the body.
Vec2 axis_of(const StoredMaterial& stored);

/// ∫ρ Nᵀ N of a rigid body in natural coordinates.
/// @param square  ∫ρ |X|², inertia about the point r [kg m²]
Eigen::Matrix4d mass_matrix(double mass, const Vec2& center, double square);
/// ∫ρ Nᵀ D of material that slides along the outlet's axis; zero of a coil.
Eigen::Matrix4d sliding_matrix(double mass, const Vec2& center, const StoredMaterial& stored);
/// ∫ρc Nᵀ N dy over the width, at a place of the body.
Eigen::Matrix4d mass_across(const StoredMaterial& stored, const Vec2& middle);

}  // namespace flexmorph::fem
