#pragma once

#include <complex>
#include <vector>

#include "fem/dofs.h"

namespace flexmorph::fem {

/// Vector of complex numbers.
using VectorXcd = Eigen::Matrix<std::complex<double>, Eigen::Dynamic, 1>;

/// Matrices of small motions y(t) with constraints:
///
///   M ÿ + C ẏ + K y + Jᵀ μ = 0,   J y = 0
///
/// They are given in units in which all entries of y have the same dimension.
struct SmallMotion {
  SparseMatrix stiffness;    ///< Stiffness matrix K (n x n).
  SparseMatrix damping;      ///< Matrix C of damping and gyroscopic forces (n x n).
  SparseMatrix mass;         ///< Mass matrix M (n x n), symmetric and positive semidefinite.
  SparseMatrix constraints;  ///< Linearly independent rows J (m x n), of length about one.

  /// True if C = 0 and K is symmetric; all eigenvalues s² are then real.
  bool is_symmetric = true;

  /// Returns the number of degrees of freedom n - m.
  int degrees_of_freedom() const { return static_cast<int>(stiffness.rows() - constraints.rows()); }
};

/// A solution y(t) = φ exp(s t) of small motions.
struct Eigenpair {
  std::complex<double> value;  ///< Eigenvalue s [1/s]; its imaginary part is not negative.
  VectorXcd shape;             ///< Eigenvector φ (n).
};

/// Returns the solutions with the smallest |s| in ascending order, one of every conjugate pair. Of
/// symmetric matrices s is imaginary, or positive where the motion grows.
///
/// The inverse operators of the shift σ need one bordered factorization (DirectSolver); Spectra
/// finds their largest eigenvalues:
///
///   M φ₀ -> φ:  (K + σ² M) φ + Jᵀ μ = M φ₀                      eigenvalues 1/(σ² - s²), Lanczos
///   (φ₀, ψ₀) -> (φ, ψ):  (K + σ C + σ² M) φ + Jᵀ μ = -(C + σ M) φ₀ - M ψ₀,   ψ = φ₀ + σ φ
///                                                               eigenvalues 1/(s - σ), Arnoldi
///
/// with J φ = 0 and ψ = s φ; the second form serves matrices that are not symmetric. A small
/// problem is reduced to the null space of J and solved by dense matrices, because it may have
/// fewer dimensions than a Krylov space needs.
///
/// Source: Ericsson & Ruhe (1980), Math. Comp. 35, 1251-1268; Tisseur & Meerbergen (2001), SIAM
/// Review 43, 235-286.
///
/// @param shift  σ [1/s], positive; fast and accurate near the lowest frequency
/// @param count  largest number of solutions
/// @throws Error (numerical) when the matrix of the shift is singular, or the iteration does not
///     converge.
std::vector<Eigenpair> eigenpairs(const SmallMotion& motion, double shift, int count);

/// Returns all solutions of a small problem, unsorted, both of every conjugate pair.
std::vector<Eigenpair> dense_eigenpairs(const SmallMotion& motion, double shift);
/// Returns solutions by the iterations of Spectra, unsorted, both of most conjugate pairs.
/// @throws Error (numerical) as eigenpairs().
std::vector<Eigenpair> krylov_eigenpairs(const SmallMotion& motion, double shift, int count);
/// Returns the number of dimensions of the Krylov space of krylov_eigenpairs().
int krylov_dimensions(const SmallMotion& motion, int count);

}  // namespace flexmorph::fem
