#pragma once

#include "fem/dofs.h"

namespace flexmorph::fem {

/// Returns an estimate of the condition number of a sparse square matrix, independent of the units
/// of its unknowns:
///
///   κ = ‖D A D‖₁ ‖(D A D)⁻¹‖₁,   D diagonal: |A_ii| becomes 1; rows of constraints, whose diagonal
///                                is zero, become of length 1
///
/// About log10 κ digits are lost in a solution. For positive definite A, the condition with this D
/// is within a factor n of the smallest that any diagonal D gives (in the 2-norm). The function
/// factors the matrix by KLU, which is too expensive for every step of a motion. The estimate is a
/// lower bound and seldom below a third of κ.
///
/// Sources: van der Sluis (1969), Numer. Math. 14, 14-23; Hager (1984), SIAM J. Sci. Stat. Comput.
/// 5, 311-316.
///
/// @returns infinity where the matrix is singular to working precision or not finite; 1 when it is
///     empty.
double condition_estimate(SparseMatrix a);

}  // namespace flexmorph::fem
