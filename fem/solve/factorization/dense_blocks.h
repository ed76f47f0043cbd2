#pragma once

#include <cblas.h>

#include "geometry/base.h"

/// Operations of a supernodal factor on one of its dense blocks (supernodal_factor.cpp).
namespace flexmorph::fem::dense {

/// View of a column-major matrix with a given distance of its columns.
using Dense = Eigen::Map<MatrixXd, 0, Eigen::OuterStride<>>;
/// Size up to which a triangle is factored without being halved.
inline constexpr Eigen::Index kUndivided = 16;

/// Computes the dense Cholesky factor of the lower triangle in place. For many small triangles it
/// is faster than LAPACK.
/// @returns the first column whose pivot is not positive, or -1.
inline Eigen::Index cholesky(Dense a) {
  const Eigen::Index n = a.rows();
  if (n > kUndivided) {
    const Eigen::Index half = n / 2, rest = n - half;
    const Eigen::OuterStride<> stride(a.outerStride());
    Dense upper(a.data(), half, half, stride), below(&a(half, 0), rest, half, stride),
        lower(&a(half, half), rest, rest, stride);
    if (const Eigen::Index failed = cholesky(upper); failed >= 0) return failed;
    upper.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(below);
    lower.selfadjointView<Eigen::Lower>().rankUpdate(below, -1);
    const Eigen::Index failed = cholesky(lower);
    return failed < 0 ? -1 : half + failed;
  }
  for (Eigen::Index c = 0; c < n; ++c) {
    if (!(a(c, c) > 0)) return c;
    a.col(c).tail(n - c) /= std::sqrt(a(c, c));
    for (Eigen::Index k = c + 1; k < n; ++k) a.col(k).tail(n - k) -= a(k, c) * a.col(c).tail(n - k);
  }
  return -1;
}

// Products with one block for `count` loads at y, `ld` apart from unknown to unknown. A single load
// uses matrix-vector products, because its cost is dominated by reading L from memory.

/// Computes y <- y L⁻ᵀ of the triangle (forward), or y L⁻¹.
inline void solve_triangle(const double* block, int width, int height, bool forward, double* y,
                           int ld, int count) {
  if (count == 1) {
    cblas_dtrsv(CblasColMajor, CblasLower, forward ? CblasNoTrans : CblasTrans, CblasNonUnit, width,
                block, height, y, ld);
  } else {
    cblas_dtrsm(CblasColMajor, CblasRight, CblasLower, forward ? CblasTrans : CblasNoTrans,
                CblasNonUnit, count, width, 1, block, height, y, ld);
  }
}

/// Computes below <- factor * below - y L_belowᵀ.
inline void push_below(const double* rectangle, int n_below, int width, int height, const double* y,
                       int ld, int count, double factor, double* below, int below_ld) {
  if (count == 1) {
    cblas_dgemv(CblasColMajor, CblasNoTrans, n_below, width, -1, rectangle, height, y, ld, factor,
                below, below_ld);
  } else {
    cblas_dgemm(CblasColMajor, CblasNoTrans, CblasTrans, count, n_below, width, -1, y, ld,
                rectangle, height, factor, below, below_ld);
  }
}

/// Computes y <- y - below L_below.
inline void pull_below(const double* rectangle, int n_below, int width, int height,
                       const double* below, int below_ld, int count, double* y, int ld) {
  if (count == 1) {
    cblas_dgemv(CblasColMajor, CblasTrans, n_below, width, -1, rectangle, height, below, below_ld,
                1, y, ld);
  } else {
    cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, count, width, n_below, -1, below,
                below_ld, rectangle, height, 1, y, ld);
  }
}

}  // namespace flexmorph::fem::dense
