#pragma once

#include <cstddef>
#include <cstring>

#include "fem/shapes/batch.h"

/// Small dense products in registers. A tile of the result, some rows (or columns) by a few SIMD
/// registers, stays in registers while all its contributions are subtracted; operands are read
/// where they are, without packing. Lanes do not depend on each other, so that every number of the
/// result has the same operations in the same order in any tile.
namespace flexmorph::fem::register_tiles {

/// Returns neighbouring numbers from memory.
template <class T>
inline T get(const double* from) {
  T out;
  std::memcpy(&out, from, sizeof out);
  return out;
}

/// Number of doubles in a type of lanes.
template <class T>
inline constexpr std::ptrdiff_t kCount = static_cast<std::ptrdiff_t>(sizeof(T) / sizeof(double));

/// Reads a tile; `at(t)` returns the location of its first lane in row t.
template <class T, int kTile, int kPacks, class At>
inline void read(T (&y)[kTile][kPacks], const At& at) {
#pragma GCC unroll 8
  for (int t = 0; t < kTile; ++t) {
    const double* from = at(t);
#pragma GCC unroll 4
    for (int p = 0; p < kPacks; ++p) y[t][p] = get<T>(from + p * kCount<T>);
  }
}

/// Writes a tile; `at(t)` returns the location of its first lane in row t.
template <class T, int kTile, int kPacks, class At>
inline void write(const T (&y)[kTile][kPacks], const At& at) {
#pragma GCC unroll 8
  for (int t = 0; t < kTile; ++t) {
    double* to = at(t);
#pragma GCC unroll 4
    for (int p = 0; p < kPacks; ++p) std::memcpy(to + p * kCount<T>, &y[t][p], sizeof(T));
  }
}

/// Subtracts a product from a tile, y_t <- y_t - Σ_k e(k, t) x_k.
/// @param count    number of terms of the sum
/// @param x        x(k) returns the location of the lanes of x_k
/// @param entry    location of e(0, 0)
/// @param by_term  distance of e(k + 1, t) from e(k, t)
/// @param by_row   distance of e(k, t + 1) from e(k, t)
template <class T, int kTile, int kPacks, class X>
inline void subtract(T (&y)[kTile][kPacks], int count, const X& x, const double* entry,
                     std::ptrdiff_t by_term, std::ptrdiff_t by_row) {
  for (int k = 0; k < count; ++k, entry += by_term) {
    const double* from = x(k);
    T lanes[kPacks];
#pragma GCC unroll 4
    for (int p = 0; p < kPacks; ++p) lanes[p] = get<T>(from + p * kCount<T>);
#pragma GCC unroll 8
    for (int t = 0; t < kTile; ++t)
#pragma GCC unroll 4
      for (int p = 0; p < kPacks; ++p) y[t][p] -= entry[t * by_row] * lanes[p];
  }
}

/// Solves with the lower triangle L (kTile x kTile by columns, their distance ld): y <- L⁻¹ y.
template <class T, int kTile, int kPacks>
inline void solve_lower(T (&y)[kTile][kPacks], const double* L, std::ptrdiff_t ld) {
#pragma GCC unroll 8
  for (int t = 0; t < kTile; ++t)
#pragma GCC unroll 4
    for (int p = 0; p < kPacks; ++p) {
#pragma GCC unroll 8
      for (int s = 0; s < t; ++s) y[t][p] -= L[s * ld + t] * y[s][p];
      y[t][p] = y[t][p] / L[t * ld + t];
    }
}

/// Calls use<k>(first) for groups of k = kLargest, 4, 2 and 1 neighbours that cover [first, last),
/// until a call returns false.
/// @returns false if a call returned false
template <int kLargest, class Use>
inline bool each_group(int first, int last, const Use& use) {
  bool keep_running = true;
  const auto groups = [&]<int k>() {
    for (; keep_running && first + k <= last; first += k)
      keep_running = use.template operator()<k>(first);
  };
  groups.template operator()<kLargest>();
  if constexpr (kLargest > 4) groups.template operator()<4>();
  if constexpr (kLargest > 2) groups.template operator()<2>();
  groups.template operator()<1>();
  return keep_running;
}

/// Number of columns of a factor that are computed together.
template <class V>
inline constexpr int kColumns = V::kParts == 1 ? 8 : 4;

/// Calls use<T, kTile, kPacks>(first) for tiles whose lanes cover [0, count). V is a pack of eight
/// numbers in the registers of the processor; kTile rows of kPacks T fit into its registers.
template <class V, class Use>
inline void each_tile(int count, const Use& use) {
  constexpr int kTile = V::kParts == 1 ? 8 : V::kParts == 2 ? 4 : 2;
  int first = 0;
  if constexpr (V::kParts == 1)
    for (; first + 3 * kLanes <= count; first += 3 * kLanes)
      use.template operator()<V, kTile, 3>(first);
  for (; first + kLanes <= count; first += kLanes) use.template operator()<V, kTile, 1>(first);
  if (first + 4 <= count) {
    use.template operator()<VectorOf<4>::Type, kTile, 1>(first);
    first += 4;
  }
  if (first + 2 <= count) {
    use.template operator()<VectorOf<2>::Type, kTile, 1>(first);
    first += 2;
  }
  if (first < count) use.template operator()<double, kTile, 1>(first);
}

}  // namespace flexmorph::fem::register_tiles
