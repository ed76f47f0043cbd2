#pragma once

#include "fem/load_law.h"
#include "fem/section.h"
#include "fem/term.h"

namespace flexmorph::fem {

/// Creates the weight of the mass of a body under gravity (dim) [m/s²].
/// @throws Error (input) at prepare() for gravity that varies on a body with free lines.
std::unique_ptr<Term> make_gravity(const PlaneSection& section, const LoadLaw& gravity);
/// Creates a point mass [kg] at a material point, with its weight when gravity is not empty.
std::unique_ptr<Term> make_point_mass(double mass, const Vec2& material, const LoadLaw& gravity);

/// Creates a force of fixed direction at a material point (dim) [N]. Model::scale_loads() scales
/// all loads of this header.
/// @throws Error (input) at prepare() for another number of components, a point outside the body,
/// and a point in an element whose lines move.
std::unique_ptr<Term> make_point_force(const Vec2& material, const LoadLaw& force);
/// Creates a load of fixed direction per reference length of an edge (dim) [N/m].
/// @throws Error (input) at prepare() for another number of components, an unknown edge, the end of
/// a beam, and an edge of elements whose lines move.
std::unique_ptr<Term> make_edge_load(const std::string& edge, const LoadLaw& load);
/// Creates a load of fixed direction per reference area (dim) [N/m²].
/// @throws Error (input) at prepare() for another number of components, and for a body with free
/// lines.
std::unique_ptr<Term> make_surface_load(const LoadLaw& load);
/// Creates a point force (dim) [N] along axes that turn with the body at the point: e₁ = r_m /
/// |r_m|, e₃ = r_m × r_n / |r_m × r_n| (z in the plane), e₂ = e₃ × e₁ (terms/turning_loads.cpp).
/// @throws Error (input) as make_point_force(), and for a body with free lines.
std::unique_ptr<Term> make_turning_point_force(const Vec2& material, const LoadLaw& force);
/// Creates a load per reference length of an edge (dim) [N/m] along axes that turn with the body at
/// every point, see make_turning_point_force().
/// @throws Error (input) as make_edge_load(), and for a body with free lines.
std::unique_ptr<Term> make_turning_edge_load(const std::string& edge, const LoadLaw& load);
/// Creates a load per reference area (dim) [N/m²] along axes that turn with the body at every
/// point, see make_turning_point_force().
/// @throws Error (input) as make_surface_load().
std::unique_ptr<Term> make_turning_surface_load(const LoadLaw& load);
/// Creates a counter-clockwise moment [N m] about a material point of a body in the plane, which
/// acts on the line across the body (r_n).
/// @throws Error (input) as make_turning_point_force(), and for a body in space.
std::unique_ptr<Term> make_moment(const Vec2& material, const LoadLaw& moment);
/// Creates a pressure [N/m²] along r_m × r_n that follows the surface of a plate in space.
/// @throws Error (input) at prepare() for a body in the plane or with material lines that move.
std::unique_ptr<Term> make_pressure(const LoadLaw& pressure);
/// Creates a moment per length [N] about an edge of a plate in space, which follows the rotation of
/// the edge and is positive where it bends with κ > 0.
/// @throws Error (input) as make_pressure().
std::unique_ptr<Term> make_edge_moment(const std::string& edge, const LoadLaw& moment);

}  // namespace flexmorph::fem
