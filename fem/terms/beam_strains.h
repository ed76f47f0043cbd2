#pragma once

#include "fem/element.h"

/// Strains of beams (elements/ancf_beam.h), either those of the displacement field or assumed
/// strains against locking.
///
///   ε̄(x, y) = ε(x, y) - ε(x, 0) + ε̄(x),   ε = (ε₁₁, ε₂₂, 2ε₁₂)
///   ε̄₁₁, 2ε̄₁₂  on the axis: parabolas through their values at the ends and the middle
///   ε̄₂₂         linear through its values at the ends
///
/// Direction 2 is along the section of the reference, direction 1 perpendicular to it. A slender
/// beam bends without stretching its axis; its sections stay perpendicular to the axis and keep
/// their height. The strains on the axis are polynomials of degree 4, 2 and 3. If they had to
/// vanish everywhere, no bending would be possible, and the membrane energy E h ε² would be too
/// large by a factor (l/h)². Samples at the ends belong to two elements. Therefore an element adds
/// two conditions on ε₁₁, two on ε₁₂ and one on ε₂₂, and has six unknowns, so that one unknown
/// remains for bending. (Two Gauss points instead of ends and middle give the same number of
/// conditions, but would leave a stretch ∝ ξ² - ξ + 1/6 of all elements without energy.) Strains
/// that depend on y have the factor h/l and do not lock.
///
/// Where sections of the reference rotate along the element, interpolated components would not
/// reproduce a uniform strain. Therefore a uniform tensor is fitted to the samples and represented
/// exactly, and only the remainder is interpolated. Where all samples are zero, the strain of the
/// axis is still zero.
///
/// ε̄ is linear in products of unknowns, like ε.
///
/// Source of the idea: Dvorkin & Bathe (1984), Eng. Comput. 1, 77-88; the samples correspond to the
/// assumed membrane strains (membrane_invariant.h) and give as few conditions as an inextensible
/// line has.
namespace flexmorph::fem {

/// Kind of the strains of a beam: those of the displacement field, or assumed ones.
enum class BeamStrains { displacement, assumed };

/// Points at which the strains of one element are evaluated. Rows of d_1, d_2: points, then the
/// point of each section on the axis, then the samples.
struct BeamStrainPoints {
  /// Number of samples: left end, middle, right end.
  static constexpr Eigen::Index kSamples = 3;
  /// Matrix that gives a strain from the strains of the samples.
  using OfSamples = Eigen::Matrix<double, 3, 3 * kSamples>;

  /// Derivatives of the shape functions along e₁ and e₂ [1/m].
  MatrixXd d_1, d_2;
  VectorXd weight;                    ///< Reference area of each point (n_points) [m²].
  std::vector<Eigen::Index> section;  ///< Section of each point.
  std::vector<double> area;           ///< Area of each section, the sum of its weights [m²].
  /// Assumed strain ε̄(x) of each section as a function of the strains ε of the samples.
  std::vector<OfSamples> assumed;

  /// Returns the number of points.
  Eigen::Index n_points() const { return weight.size(); }
  /// Returns the row of the point of a section on the axis.
  Eigen::Index on_axis(Eigen::Index section) const { return n_points() + section; }
  /// Returns the row of a sample.
  Eigen::Index sample(Eigen::Index k) const {
    return n_points() + static_cast<Eigen::Index>(area.size()) + k;
  }
};

/// Returns the strain points of an element, which integrate polynomials of degree 8.
/// @param element  with vectors r, r_x, r_y at each of two nodes
/// @param reference  Element::reference()
/// @throws Error (input) for scale factors that are not uniform.
BeamStrainPoints beam_strain_points(const Element& element, int e, const ScaleFactors& factors,
                                    const MatrixXd& reference);

}  // namespace flexmorph::fem
