#pragma once

#include <array>

#include "fem/element.h"

namespace flexmorph::fem {

/// Distinct pairs of vectors of an element, sorted into blocks that W does not couple: pair p is
/// (i[p], j[p]), block c contains the pairs from starts[c] to starts[c + 1]. See gram::Numbering.
struct PairNumbers {
  /// Vectors of each pair, and the first pair of each block.
  std::vector<int> i, j, starts;
};

/// Indices of the entries of W in sums over the points (membrane_invariant.cpp); they are equal for
/// all elements of one kind.
struct InvariantIndices {
  /// Index in the sums of normal strains for each entry of W.
  std::vector<int> normal;
  /// Four indices in the sums of shear strains for each entry of W.
  std::vector<std::array<int, 4>> shear;
};
/// Returns the indices of the entries of W.
/// @param function_m, function_n  function of one coordinate that belongs to every vector
InvariantIndices invariant_indices(const PairNumbers& pairs, const std::vector<int>& function_m,
                                   const std::vector<int>& function_n);

/// Returns a table with the sums and differences of the functions of one coordinate, which are even
/// or odd over the element, instead of the functions themselves.
/// @param function_m, function_n  even or odd function of every vector
ProductTable even_and_odd(const ProductTable& table, const std::vector<int>& function_m,
                          const std::vector<int>& function_n);

/// Kind of the membrane strains: those of the displacement field, or assumed ones against locking.
enum class Strains { displacement, assumed };

/// Returns the matrix (n x n) that interpolates a polynomial of degree below n by the parabola
/// through its values at 0, 1/2 and 1; both are given by their values at the n Gauss points.
MatrixXd parabola_through_samples(int n);

/// Returns W = ∫ Λᵀ C Λ dA of the Gram form U = ½ (g - g°)ᵀ W (g - g°) for the strains of the
/// displacement field. The entries of g are q_i · q_j, half of it where i = j;
/// fem/terms/membrane.cpp.
///
/// @param table  products at points that integrate polynomials of degree 12 in each direction
/// @param elasticity  h C, Voigt order 11, 22, 12, without coupling of normal strains and shear
/// @returns lower triangles of the blocks of W, row by row
std::vector<double> membrane_invariant(const ProductTable& table,
                                       const InvariantIndices& value_indices,
                                       const Eigen::Matrix3d& elasticity);
/// Returns W of the Gram form for assumed strains, see membrane_invariant().
///
/// Assumed strains are sampled at the ends and the middle of an element and interpolated by a
/// parabola: ε₁₁ along m, ε₂₂ along n, ε₁₂ in both directions. The strains of an element are
/// polynomials that must vanish everywhere in bending without stretching, which are more conditions
/// than the positions can satisfy. Samples at the ends belong to two elements, so that each element
/// adds two conditions per line, as many as an inextensible line has. ε̄ is linear in g, so that W
/// has as many entries as for the displacement field and is evaluated by the same functions.
std::vector<double> assumed_membrane_invariant(const ProductTable& table, const PairNumbers& pairs,
                                               const Eigen::Matrix3d& elasticity);

/// Returns the blocks of W as full squares, one after the other, from their lower triangles.
std::vector<double> full_squares(const PairNumbers& pairs, const std::vector<double>& triangles);

}  // namespace flexmorph::fem
