#pragma once

#include "fem/element.h"

namespace flexmorph::fem {

/// Assumed membrane strains of a plate, against locking in thin bending.
///
/// The strains of an element are polynomials, ε = Λ(X) (g - g°) in the Gram entries g. Bending
/// without stretching must make them zero everywhere, which asks for more than the positions can
/// give. Instead they are sampled at the ends and the middle of an element and interpolated between
/// (a parabola): ε₁₁ along m, ε₂₂ along n, ε₁₂ both ways. Samples at the ends belong to two
/// elements, so that each element adds two conditions per line, as many as an inextensible line
/// has. ε̄ is still linear in g: the invariant W = ∫ Λ̄ᵀ C Λ̄ dA has the size of Membrane's and serves
/// the same evaluation.
///
/// @param table       products at points that integrate polynomials of degree 6 each way at least
/// @param elasticity  h C, Voigt order 11, 22, 12, without coupling of normal strains and shear
/// @param i, j        vectors of every pair; entries of g are q_i · q_j, half of it where i = j
/// @return W (n_pairs x n_pairs)
MatrixXd assumed_membrane_invariant(const ProductTable& table, std::span<const int> i,
                                    std::span<const int> j, const Eigen::Matrix3d& elasticity);

}  // namespace flexmorph::fem
