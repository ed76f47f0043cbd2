#pragma once

#include "fem/section.h"
#include "fem/term.h"

namespace flexmorph::fem {

/// Weight of the body's own mass; gravity (dim) [m/s^2].
std::unique_ptr<Term> make_gravity(const PlaneSection& section, const VectorXd& gravity);
/// A mass [kg] at a material point, with its weight when gravity is not empty.
std::unique_ptr<Term> make_point_mass(double mass, const Vec2& material, const VectorXd& gravity);

/// Loads that keep their size and direction, per reference length and area; components as the body
/// has dimensions. All loads are scaled by Model::scale_loads().
/// @throws Error (input) at prepare() for other components, a point outside the body, an unknown
/// edge; point and edge loads also in elements whose lines move.
std::unique_ptr<Term> make_point_force(const Vec2& material, const VectorXd& force);  // [N]
std::unique_ptr<Term> make_edge_load(const std::string& edge, const VectorXd& load);  // [N/m]
std::unique_ptr<Term> make_surface_load(const VectorXd& load);                        // [N/m²]
/// Loads that follow the surface of a plate in space: a pressure [N/m²] along r_m × r_n, and a
/// moment per length [N] of an edge about the edge, positive where it bends with κ > 0.
/// @throws Error (input) at prepare() for a body in the plane or with material lines that move.
std::unique_ptr<Term> make_pressure(double pressure);
std::unique_ptr<Term> make_edge_moment(const std::string& edge, double moment);

}  // namespace flexmorph::fem
