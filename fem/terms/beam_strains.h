#pragma once

#include "fem/element.h"

/// Strains of beams (elements/ancf_beam.h), as the displacements have them and assumed against
/// locking.
///
///   ε̄(x, y) = ε(x, y) - ε(x, 0) + ε̄(x),   ε = (ε₁₁, ε₂₂, 2ε₁₂)
///   ε̄₁₁, 2ε̄₁₂  on the axis: parabolas through their values at the ends and the middle
///   ε̄₂₂         linear through its values at the ends
///
/// 2: along the section of the reference, 1: at right angles to it. A slender beam bends without
/// stretching its axis, its sections at right angles to the axis and as high as they were. Strains
/// of the axis have the degrees 4, 2 and 3; zero everywhere they allow no bending at all, and the
/// membrane energy E h ε² is (l/h)² times too much of it. Samples at the ends belong to two
/// elements: an element adds two conditions on ε₁₁, two on ε₁₂, one on ε₂₂ and has six unknowns,
/// one of which is left to bend. (Two Gauss points instead of ends and middle count alike, but a
/// stretch ∝ ξ² - ξ + 1/6 of all elements would be free.) What depends on y has the factor h/l and
/// does not lock.
///
/// Where sections of the reference turn along the element, interpolated components would miss a
/// uniform strain. So a uniform tensor is fitted to the samples, represented exactly, and the rest
/// interpolated; where all samples are zero the strain of the axis still is.
///
/// ε̄ is linear in products of unknowns, as ε.
///
/// Source of the idea: Dvorkin & Bathe (1984), Eng. Comput. 1, 77-88; of the samples: those of the
/// assumed membrane (membrane_invariant.h), with as few conditions as an inextensible line has.
namespace flexmorph::fem {

enum class BeamStrains { displacement, assumed };

/// Where the strains of one element are taken. Rows of d_1, d_2: points, then the point of each
/// section on the axis, then the samples.
struct BeamStrainPoints {
  static constexpr Eigen::Index kSamples = 3;  // ends and middle: left end, middle, right end
  using OfSamples = Eigen::Matrix<double, 3, 3 * kSamples>;

  MatrixXd d_1, d_2;  ///< derivatives of the shape functions along e₁ and e₂ [1/m]
  VectorXd weight;    ///< reference area of points (n_points) [m²]
  std::vector<Eigen::Index> section;  ///< of points
  std::vector<double> area;           ///< of sections: the sum of their weights [m²]
  std::vector<OfSamples> assumed;     ///< ε̄(x) of sections from ε of the samples, one by one

  Eigen::Index n_points() const { return weight.size(); }
  Eigen::Index on_axis(Eigen::Index section) const { return n_points() + section; }
  Eigen::Index sample(Eigen::Index k) const {
    return n_points() + static_cast<Eigen::Index>(area.size()) + k;
  }
};

/// At points that integrate polynomials of degree 8.
/// @param element    with vectors r, r_x, r_y at each of two nodes
/// @param reference  Element::reference()
/// @throws Error (input) for factors that are not uniform.
BeamStrainPoints beam_strain_points(const Element& element, int e, const Factors& factors,
                                    const MatrixXd& reference);

}  // namespace flexmorph::fem
