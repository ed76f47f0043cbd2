#pragma once

#include <functional>
#include <span>
#include <vector>

#include "geometry/components/component.h"
#include "geometry/components/outline.h"
#include "geometry/grid.h"

/// Evaluates designs by the published program of generalized geometry projection: the densities
/// that it assigns to elements, and the compliance that it prints.
///
/// Source: Coniglio, Morlier, Gogu & Amargier (2020), Arch. Comput. Methods Eng. 27, 1573-1610, and
/// its program (github.com/topggp/GGP-Matlab, method GP with the settings it is published with).
namespace flexmorph::benchmark {

/// A component: the distance of a point from its outline (negative inside), and its mass.
struct ProjectedFeature {
  std::function<double(const Vec2&)> outside;  ///< ζ [m].
  double mass = 1;                             ///< m: the stiffness is proportional to m³ [-].
};
/// Returns a bar with round ends as in the published program: the points within h / 2 of an axis of
/// length L.
ProjectedFeature round_bar(const Vec2& center, double length, double thickness, double angle,
                           double mass);
/// Returns a component of this program, limited to its least half-thickness.
ProjectedFeature feature_of(const Component& component, double min_half_thickness);
/// Returns all components as one feature, which is continued outside of the box.
ProjectedFeature feature_of(std::span<const Component> components, double min_half_thickness,
                            const Box& box);

/// Values of all elements (n_cells).
struct ProjectedElements {
  VectorXd stiffness, density;
  double volume() const { return density.mean(); }
};
/// Returns the values of elements of side 1. For each feature i and element
///
///   δ_i = mean of W over 2 x 2 Gauss points,   W = fraction of a disc of radius 1/2 around the
///   point
///         that is inside of a straight outline at ζ, at least 1e-6
///   y   = 1/k log(mean_i exp(k δ_i m_i^γ)),  k = 10,    ρ = s(y / y(one feature with δ = 1))
///   s(t) = (-log(e^-p + 1/(e^(p t) + 1))/p - s0)/(1 - s0),  p = 100, s0 so that s(0) = 0
///
/// with γ = 3 for the stiffness and 1 for the density. If all masses are 1 both are equal: a half
/// filled element has half of the stiffness.
ProjectedElements project(const Grid& grid, std::span<const ProjectedFeature> features);

/// Returns F . u of the published short cantilever: elements of unit thickness, E = 1, ν = 0.3, the
/// left edge held, a unit force downwards at the middle of the right edge.
/// @throws Error (numerical) if the elements carry no load
double short_cantilever(const Grid& grid, const VectorXd& stiffness);

}  // namespace flexmorph::benchmark
