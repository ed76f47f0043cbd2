#pragma once

#include <span>

#include "fem/terms/eulerian_work.h"

/// Effect of the flow of material through the mesh on the strain energy of an element. With the
/// energy density W per area and mesh lines that move at the rates ṁ,
///
///   dU/dt at fixed unknowns = ∫ (∂W/∂t at fixed material point) dA + Σ ± ṁ ∫ W dn
///                             flow power                             energy on the lines
namespace flexmorph::fem {

/// Returns the flow power of a density [W].
/// @param t  with the rates of the derivatives that the density needs
double flow_power(const EnergyDensity& density, const ShapeTable& t, const LocalRows& q);

/// Adds W at the points of a line, see Term::add_line_energy().
void add_line_energy(const EnergyDensity& density, std::span<const ShapeTable> line,
                     const LocalRows& q, VectorXd& out);

/// Returns the strains at the points of a line (n x size of the strain).
MatrixXd strains_on_line(const StrainMeasure& measure, std::span<const ShapeTable> line,
                         const LocalRows& q);

/// Interpolation of assumed membrane strains under material flow. Membrane strains that are sampled
/// and interpolated (membrane_invariant.h) have their samples at fixed local coordinates. A strain
/// ε(s) along one direction, interpolated by ε̄ = A ε from its values at n Gauss points, has at a
/// fixed material point, which moves by ṡ(s), the rate
///
///   ∂ε̄/∂t = A (∂ε/∂t - ṡ ε') + ṡ (A ε)' = A ∂ε/∂t + K ε,   K = C D A - A C D
///
/// with D the derivative of values at the points and C = diag(ṡ).
struct ParabolaFlow {
  MatrixXd A, K;  ///< Matrices A and K of the formula (n x n).
  /// Computes the matrices for n Gauss points.
  /// @param start, end  motion of the lines on both sides of the element in this direction
  ParabolaFlow(int n, const Motion& start, const Motion& end);
};

/// Returns the flow power of assumed membrane strains [W], in a closed form of the result of
/// ElasticTerm (density_term.h).
/// @param elasticity  h C [N/m]
double assumed_flow_power(const Element& element, int e, const ScaleFactors& factors,
                          const Eigen::Matrix3d& elasticity, const LocalRows& q);
/// Adds the energy of assumed membrane strains at the points of a line, in a closed form of the
/// result of ElasticTerm (density_term.h).
/// @param elasticity  h C [N/m]
void add_assumed_line_energy(std::span<const ShapeTable> line, const Eigen::Matrix3d& elasticity,
                             const LocalRows& q, VectorXd& out);

}  // namespace flexmorph::fem
