#pragma once

#include "fem/load_law.h"
#include "fem/section.h"
#include "fem/term.h"

namespace flexmorph::fem {

/// Weight of the body's own mass; gravity (dim) [m/s^2].
/// @throws Error (input) at prepare() for gravity that varies on a body with free lines.
std::unique_ptr<Term> make_gravity(const PlaneSection& section, const LoadLaw& gravity);
/// A mass [kg] at a material point, with its weight when gravity is not empty.
std::unique_ptr<Term> make_point_mass(double mass, const Vec2& material, const LoadLaw& gravity);

/// Loads that keep their direction, per reference length and area; components as the body has
/// dimensions. All loads are scaled by Model::scale_loads().
/// @throws Error (input) at prepare() for other components, a point outside the body, an unknown
/// edge; point and edge loads also in elements whose lines move.
std::unique_ptr<Term> make_point_force(const Vec2& material, const LoadLaw& force);  // [N]
std::unique_ptr<Term> make_edge_load(const std::string& edge, const LoadLaw& load);  // [N/m]
std::unique_ptr<Term> make_surface_load(const LoadLaw& load);                        // [N/m²]
/// The same along axes that turn with the body at every point: r_m / |r_m|, in the plane its
/// quarter turn, in space the normal of the surface and what is left (terms/turning_loads.cpp).
/// @throws Error (input) likewise, and on bodies with free lines.
std::unique_ptr<Term> make_turning_point_force(const Vec2& material, const LoadLaw& force);
std::unique_ptr<Term> make_turning_edge_load(const std::string& edge, const LoadLaw& load);
std::unique_ptr<Term> make_turning_surface_load(const LoadLaw& load);
/// Moment [N m] in the plane on the line across a body (r_n) at a material point,
/// counter-clockwise. @throws Error (input) likewise.
std::unique_ptr<Term> make_moment(const Vec2& material, const LoadLaw& moment);
/// Loads that follow the surface of a plate in space: a pressure [N/m²] along r_m × r_n, and a
/// moment per length [N] of an edge about the edge, positive where it bends with κ > 0.
/// @throws Error (input) at prepare() for a body in the plane or with material lines that move.
std::unique_ptr<Term> make_pressure(const LoadLaw& pressure);
std::unique_ptr<Term> make_edge_moment(const std::string& edge, const LoadLaw& moment);

}  // namespace flexmorph::fem
