#pragma once

#include <span>

#include "fem/terms/free_work.h"

/// What the flow of material through a standing mesh does to the strain energy of an element: with
/// the density W per area and a mesh of which lines move at the rates ṁ,
///
///   dU/dt at fixed unknowns = ∫ (∂W/∂t at fixed material point) dA + Σ ± ṁ ∫ W dn
///                             flow power                             energy on the lines
namespace flexmorph::fem {

/// The flow power of a density [W].
/// @param t  with the rates of the derivatives that the density asks for
double flow_power(const EnergyDensity& density, const ShapeTable& t, const LocalRows& q);

/// Adds W at the points of a line, see Term::add_line_energy().
void add_line_energy(const EnergyDensity& density, std::span<const ShapeTable> line,
                     const LocalRows& q, VectorXd& out);

/// Strains at the points of a line (n x size of the strain).
MatrixXd strains_on_line(const StrainMeasure& measure, std::span<const ShapeTable> line,
                         const LocalRows& q);

/// Membrane strains that are sampled and interpolated (membrane_invariant.h) have their samples at
/// fixed local coordinates. A strain ε(s) along one direction, interpolated by ε̄ = A ε from its
/// values at n Gauss points, has at a fixed material point, which moves by ṡ(s),
///
///   ∂ε̄/∂t = A (∂ε/∂t - ṡ ε') + ṡ (A ε)' = A ∂ε/∂t + K ε,   K = C D A - A C D
///
/// D the derivative of values at the points, C = diag(ṡ).
struct ParabolaFlow {
  MatrixXd A, K;  ///< (n x n)
  /// @param start, end  the lines that the element lies between in that direction
  ParabolaFlow(int n, const Motion& start, const Motion& end);
};

/// The flow power of assumed membrane strains, and their energy on a line: closed forms of what
/// ElasticTerm computes (density_term.h).
/// @param elasticity  h C [N/m]
double assumed_flow_power(const Element& element, int e, const Factors& factors,
                          const Eigen::Matrix3d& elasticity, const LocalRows& q);
void add_assumed_line_energy(std::span<const ShapeTable> line, const Eigen::Matrix3d& elasticity,
                             const LocalRows& q, VectorXd& out);

}  // namespace flexmorph::fem
