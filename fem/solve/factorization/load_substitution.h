#pragma once

#include "fem/solve/factorization/register_tiles.h"

/// Substitution of many right-hand sides through a block of neighbouring columns of a Cholesky
/// factor: a dense lower triangle above a rectangle, stored by columns. Right-hand sides are stored
/// as (n_loads x n), the values of all loads at one unknown next to each other, and SIMD lanes are
/// loads. Rows below the triangle are read and written where they are. Therefore small blocks, in
/// which most of the work is done, need neither the packing nor the gathering of products of BLAS
/// (measured: 0.65 to 0.75 of the time for 20 and 100 loads).
///
/// Every load has the same operations in the same order, whatever loads stand beside it.
namespace flexmorph::fem {

/// One block of columns of a factor and the right-hand sides it acts on.
struct LoadBlock {
  const double* block;  ///< (height x width) by columns; entries above the diagonal are not read.
  int width, height;    ///< Columns of the block, rows of the block.
  int first;            ///< First unknown of the block.
  const int* below;     ///< Unknowns of the rows below the triangle (height - width).
  double* x;            ///< Right-hand sides: the first load of the range at unknown 0.
  std::ptrdiff_t distance;  ///< Distance from an unknown to the next one in x (n_loads).
  int count;                ///< Number of loads of the range.

  /// Returns the values of the loads at a row of the block.
  double* row(int r) const { return x + distance * (r < width ? first + r : below[r - width]); }
};

namespace load_substitution {

using namespace register_tiles;

/// Computes kTile rows of y <- L⁻¹ y from `r` on; all lie in the triangle or all below it.
template <class T, int kTile, int kPacks>
inline void forward_rows(const LoadBlock& b, int load, int r) {
  T y[kTile][kPacks];
  const auto at = [&](int k) { return b.row(k) + load; };
  const auto of_tile = [&](int t) { return b.row(r + t) + load; };
  const std::ptrdiff_t h = b.height;
  read<T>(y, of_tile);
  subtract(y, r < b.width ? r : b.width, at, b.block + r, h, 1);
  if (r < b.width) solve_lower(y, b.block + r * h + r, h);
  write<T>(y, of_tile);
}

/// Computes the columns [c, c + kTile) of y <- L⁻ᵀ y, given all rows behind them.
template <class T, int kTile, int kPacks>
inline void backward_columns(const LoadBlock& b, int load, int c) {
  T y[kTile][kPacks];
  const auto behind = [&](int k) { return b.row(c + kTile + k) + load; };
  const auto of_tile = [&](int t) { return b.row(c + t) + load; };
  const std::ptrdiff_t h = b.height;
  read<T>(y, of_tile);
  subtract(y, b.height - c - kTile, behind, b.block + c * h + c + kTile, 1, h);
  const double* L = b.block + c * h + c;
#pragma GCC unroll 8
  for (int t = kTile - 1; t >= 0; --t)
#pragma GCC unroll 4
    for (int p = 0; p < kPacks; ++p) {
#pragma GCC unroll 8
      for (int s = t + 1; s < kTile; ++s) y[t][p] -= L[t * h + s] * y[s][p];
      y[t][p] = y[t][p] / L[t * h + t];
    }
  write<T>(y, of_tile);
}

/// Computes L⁻¹ y for kPacks vectors of loads from `load` on.
template <class T, int kTile, int kPacks>
inline void forward(const LoadBlock& b, int load) {
  const auto rows = [&](int first, int last) {
    each_group<kTile>(first, last, [&]<int n>(int r) {
      forward_rows<T, n, kPacks>(b, load, r);
      return true;
    });
  };
  rows(0, b.width);
  rows(b.width, b.height);
}
/// Computes L⁻ᵀ y for kPacks vectors of loads from `load` on.
template <class T, int kTile, int kPacks>
inline void backward(const LoadBlock& b, int load) {
  int c = b.width;
  for (; c % 2 != 0; --c) backward_columns<T, 1, kPacks>(b, load, c - 1);
  if constexpr (kTile > 2)
    for (; c % 4 != 0; c -= 2) backward_columns<T, 2, kPacks>(b, load, c - 2);
  if constexpr (kTile > 4)
    for (; c % kTile != 0; c -= 4) backward_columns<T, 4, kPacks>(b, load, c - 4);
  for (; c > 0; c -= kTile) backward_columns<T, kTile, kPacks>(b, load, c - kTile);
}

}  // namespace load_substitution

/// Replaces the rows of the triangle by L⁻¹ y for all loads of the range and subtracts their
/// contribution from the rows below.
inline void forward_loads(const LoadBlock& b) {
  run_batch_kernel([&]<class V>() {
    register_tiles::each_tile<V>(b.count, [&]<class T, int kTile, int kPacks>(int load) {
      load_substitution::forward<T, kTile, kPacks>(b, load);
    });
  });
}

/// Replaces the rows of the triangle by L⁻ᵀ y for all loads of the range, given the rows below.
inline void backward_loads(const LoadBlock& b) {
  run_batch_kernel([&]<class V>() {
    register_tiles::each_tile<V>(b.count, [&]<class T, int kTile, int kPacks>(int load) {
      load_substitution::backward<T, kTile, kPacks>(b, load);
    });
  });
}

}  // namespace flexmorph::fem
