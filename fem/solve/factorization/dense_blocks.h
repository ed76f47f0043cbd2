#pragma once

#include <cblas.h>

#include <algorithm>
#include <cmath>

#include "fem/solve/factorization/register_tiles.h"

/// Factorization of one block of neighbouring columns of a supernodal factor (multifrontal.cpp): a
/// dense lower triangle above a rectangle, by columns. Most blocks are small; there products in
/// registers take less time than calls of BLAS, which pack their operands first.
namespace flexmorph::fem::dense {

using namespace register_tiles;

/// Computes the Cholesky factor of a triangle of n <= 8 columns in place.
/// @returns the first column whose pivot is not positive, or -1
inline int factor_triangle(double* a, std::ptrdiff_t ld, int n) {
  for (int c = 0; c < n; ++c) {
    double* column = a + c * ld;
    if (!(column[c] > 0)) return c;
    const double pivot = std::sqrt(column[c]);
    for (int r = c; r < n; ++r) column[r] /= pivot;
    for (int k = c + 1; k < n; ++k)
      for (int r = k; r < n; ++r) a[k * ld + r] -= column[k] * column[r];
  }
  return -1;
}

/// Subtracts the product of the columns before c from the columns [c, c + kTile) of the rows of
/// one tile, and with `solve` divides by the triangle of these columns.
/// @param block  first row and column
template <class T, int kTile, int kPacks>
inline void factor_rows(double* block, std::ptrdiff_t ld, int c, int row, bool solve) {
  T y[kTile][kPacks];
  double* target = block + c * ld + row;
  read<T>(y, [&](int t) { return target + t * ld; });
  subtract(
      y, c, [&](int k) { return block + k * ld + row; }, block + c, ld, 1);
  if (solve) solve_lower(y, block + c * ld + c, ld);
  write<T>(y, [&](int t) { return target + t * ld; });
}

/// Factors a block of few columns.
/// @returns the first column whose pivot is not positive, or -1
template <class V>
inline int factor_panel(double* block, std::ptrdiff_t ld, int width, int height) {
  int failed = -1;
  each_group<kColumns<V>>(0, width, [&]<int n>(int c) {
    // Rows of the triangle are computed one by one, entries above the diagonal are not used.
    for (int r = c; r < c + n; ++r) factor_rows<double, n, 1>(block, ld, c, r, false);
    failed = factor_triangle(block + c * ld + c, ld, n);
    if (failed >= 0) {
      failed += c;
      return false;
    }
    each_tile<V>(height - c - n, [&]<class T, int kTile, int kPacks>(int r) {
      factor_rows<T, n, kPacks>(block, ld, c, c + n + r, true);
    });
    return true;
  });
  return failed;
}

/// Factors a block: its triangle becomes L, its rectangle B becomes B L⁻ᵀ.
/// @param block  (height x width); entries above the diagonal are not read and may change
/// @returns the first column whose pivot is not positive, or -1
inline int factor_block(double* block, int width, int height) {
  constexpr int kPanel = 48;  // from this width on products of BLAS are faster
  for (int c = 0; c < width; c += kPanel) {
    const int n = std::min(kPanel, width - c), rest = width - c - n, below = height - width;
    double* panel = block + static_cast<std::ptrdiff_t>(c) * height + c;
    int failed = -1;
    run_batch_kernel([&]<class V>() { failed = factor_panel<V>(panel, height, n, height - c); });
    if (failed >= 0) return c + failed;
    if (rest == 0) continue;
    double* next = panel + static_cast<std::ptrdiff_t>(n) * height + n;
    cblas_dsyrk(CblasColMajor, CblasLower, CblasNoTrans, rest, n, -1, panel + n, height, 1, next,
                height);
    if (below > 0)
      cblas_dgemm(CblasColMajor, CblasNoTrans, CblasTrans, below, rest, n, -1, panel + n + rest,
                  height, panel + n, height, 1, next + rest, height);
  }
  return -1;
}

/// Computes the columns [c, c + kTile) of own <- keep * own - B Bᵀ in the rows of one tile.
template <class T, int kTile, int kPacks>
inline void update_rows(const double* B, std::ptrdiff_t ld, int width, bool keep, double* own,
                        std::ptrdiff_t own_ld, int c, int row) {
  T y[kTile][kPacks];
  double* target = own + c * own_ld + row;
  if (keep)
    read<T>(y, [&](int t) { return target + t * own_ld; });
  else
    for (auto& of_column : y)
      for (T& value : of_column) value = T{};
  subtract(
      y, width, [&](int k) { return B + k * ld + row; }, B + c, ld, 1);
  write<T>(y, [&](int t) { return target + t * own_ld; });
}

/// Computes the lower triangle of own <- keep * own - B Bᵀ.
/// @param B    (n x width) by columns, their distance ld
/// @param own  (n x n); entries above the diagonal may change
inline void update(const double* B, int ld, int n, int width, bool keep, double* own) {
  // Smaller products are faster in registers (measured on factors of plates).
  constexpr double kMinBlasProduct = 64.0 * 64 * 48;
  if (static_cast<double>(n) * n * width > kMinBlasProduct) {
    cblas_dsyrk(CblasColMajor, CblasLower, CblasNoTrans, n, width, -1, B, ld, keep ? 1 : 0, own, n);
    return;
  }
  run_batch_kernel([&]<class V>() {
    each_group<kColumns<V>>(0, n, [&]<int k>(int c) {
      each_tile<V>(n - c, [&]<class T, int kTile, int kPacks>(int r) {
        update_rows<T, k, kPacks>(B, ld, width, keep, own, n, c, c + r);
      });
      return true;
    });
  });
}

}  // namespace flexmorph::fem::dense
