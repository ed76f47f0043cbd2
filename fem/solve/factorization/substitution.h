#pragma once

#include <cstring>

#include "fem/shapes/batch.h"

/// Substitution of one right-hand side through a block of neighbouring columns of a Cholesky
/// factor: a dense lower triangle above a rectangle, stored by columns. Its speed is limited by the
/// rate at which the factor is read from memory; therefore eight columns are processed at a time,
/// and every number is read once. (With trsv and gemv of BLAS, as in CHOLMOD, a solution takes 1.3
/// to 1.5 times as long.)
namespace flexmorph::fem {
namespace substitution {

/// Loads a pack of SIMD lanes from consecutive numbers.
template <class V>
inline V load(const double* x) {
  V out;
  std::memcpy(&out, x, sizeof out);
  return out;
}

/// Eliminates kColumns columns from a diagonal entry on: y <- L⁻¹ y in their rows, and subtracts
/// their contribution from the rows below, up to `height` rows in all.
template <class V, int kColumns>
inline void forward(const double* L, std::ptrdiff_t ld, std::ptrdiff_t height, double* y) {
  double x[kColumns];
  for (int a = 0; a < kColumns; ++a) {
    x[a] = y[a];
    for (int b = 0; b < a; ++b) x[a] -= L[b * ld + a] * x[b];
    x[a] /= L[a * ld + a];
    y[a] = x[a];
  }
  std::ptrdiff_t i = kColumns;
  for (; i + kLanes <= height; i += kLanes) {
    V sum = load<V>(y + i);
#pragma GCC unroll 8
    for (int a = 0; a < kColumns; ++a) sum -= x[a] * load<V>(L + a * ld + i);
    std::memcpy(y + i, &sum, sizeof sum);
  }
  for (; i < height; ++i)
    for (int a = 0; a < kColumns; ++a) y[i] -= x[a] * L[a * ld + i];
}

/// Computes y <- L⁻ᵀ y in the rows of kColumns columns from a diagonal entry on, given the values
/// in the rows below, `height` rows in all.
template <class V, int kColumns>
inline void backward(const double* L, std::ptrdiff_t ld, std::ptrdiff_t height, double* y) {
  V sums[kColumns] = {};
  std::ptrdiff_t i = kColumns;
  for (; i + kLanes <= height; i += kLanes) {
    const V yi = load<V>(y + i);
#pragma GCC unroll 8
    for (int a = 0; a < kColumns; ++a) sums[a] += yi * load<V>(L + a * ld + i);
  }
  double x[kColumns];
  for (int a = 0; a < kColumns; ++a) {
    x[a] = y[a];
    for (int lane = 0; lane < kLanes; ++lane) x[a] -= sums[a][lane];
  }
  for (; i < height; ++i)
    for (int a = 0; a < kColumns; ++a) x[a] -= y[i] * L[a * ld + i];
  for (int a = kColumns - 1; a >= 0; --a) {
    for (int b = a + 1; b < kColumns; ++b) x[a] -= L[a * ld + b] * x[b];
    x[a] /= L[a * ld + a];
    y[a] = x[a];
  }
}

}  // namespace substitution

/// Replaces the first `width` entries of y (height) by L⁻¹ y and subtracts their contribution from
/// the others.
/// @param block  (height x width) by columns; entries above the diagonal are not read
inline void forward_block(const double* block, int width, int height, double* y) {
  run_batch_kernel([=]<class V>() {
    int j = 0;
    const auto columns = [&]<int n>() {
      for (; j + n <= width; j += n)
        substitution::forward<V, n>(block + std::ptrdiff_t{j} * height + j, height, height - j,
                                    y + j);
    };
    columns.template operator()<8>();
    columns.template operator()<4>();
    columns.template operator()<1>();
  });
}

/// Replaces the first `width` entries of y (height) by L⁻ᵀ y, given the others.
inline void backward_block(const double* block, int width, int height, double* y) {
  run_batch_kernel([=]<class V>() {
    int j = width;
    const auto columns = [&]<int n>(int until) {
      for (; j - n >= until; j -= n) {
        const int k = j - n;
        substitution::backward<V, n>(block + std::ptrdiff_t{k} * height + k, height, height - k,
                                     y + k);
      }
    };
    const int eights = width / 8 * 8, fours = width / 4 * 4;
    columns.template operator()<1>(fours);
    columns.template operator()<4>(eights);
    columns.template operator()<8>(0);
  });
}

}  // namespace flexmorph::fem
