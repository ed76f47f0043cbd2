#pragma once

#include <array>

#include "fem/element.h"

namespace flexmorph::fem {

/// Distinct pairs of vectors of an element, sorted into blocks that W does not couple: pair p is
/// (i[p], j[p]), block c the pairs from starts[c] to starts[c + 1]. See gram::Numbering.
struct PairNumbers {
  std::vector<int> i, j, starts;
};

/// Where the entries of W stand in sums over the points (membrane_invariant.cpp): the same for all
/// elements of one kind.
struct InvariantPlaces {
  std::vector<int> normal;                ///< one for each entry of W
  std::vector<std::array<int, 4>> shear;  ///< likewise
};
InvariantPlaces invariant_places(const PairNumbers& pairs, const std::vector<int>& function_m,
                                 const std::vector<int>& function_n);

/// A table of sums and differences of the functions of one coordinate, which are even or odd over
/// the element, instead of those functions; function_m, function_n: those of every vector.
ProductTable even_and_odd(const ProductTable& table, const std::vector<int>& function_m,
                          const std::vector<int>& function_n);

/// Membrane strains as the displacements have them, or assumed ones against locking.
enum class Strains { displacement, assumed };

/// Parabola through the values at 0, 1/2 and 1 of a polynomial of degree below n, all by values at
/// the n Gauss points (n x n).
MatrixXd parabola_through_samples(int n);

/// W = ∫ Λᵀ C Λ dA of the Gram form U = ½ (g - g°)ᵀ W (g - g°), entries of g being q_i · q_j, half
/// of it where i = j; fem/terms/membrane.cpp.
///
/// Assumed strains are sampled at the ends and the middle of an element and interpolated between (a
/// parabola): ε₁₁ along m, ε₂₂ along n, ε₁₂ both ways. The strains of an element are polynomials
/// that bending without stretching must make zero everywhere, which asks for more than the
/// positions can give; samples at the ends belong to two elements, so that each element adds two
/// conditions per line, as many as an inextensible line has. ε̄ is still linear in g: W has the same
/// size and serves the same evaluation.
///
/// @param table       products at points that integrate polynomials of degree 12 each way (6:
/// assumed)
/// @param elasticity  h C, Voigt order 11, 22, 12, without coupling of normal strains and shear
/// @return lower triangles of the blocks of W, row by row
std::vector<double> membrane_invariant(const ProductTable& table, const InvariantPlaces& places,
                                       const Eigen::Matrix3d& elasticity);
std::vector<double> assumed_membrane_invariant(const ProductTable& table, const PairNumbers& pairs,
                                               const Eigen::Matrix3d& elasticity);

/// The blocks of W as full squares, one after the other, from their lower triangles.
std::vector<double> full_squares(const PairNumbers& pairs, const std::vector<double>& triangles);

}  // namespace flexmorph::fem
