#pragma once

#include <array>
#include <vector>

#include "fem/terms/bending_point.h"

/// Integrals of the bending energy over an element and their derivatives with respect to its
/// unknowns, for one element (V = double) or eight side by side (V = PackOf<...>).
///
/// Shape functions are products of functions f_i(m) f_j(n), i, j = 0 ... 3, and the points form a
/// tensor grid (g, h). Therefore every sum over functions and every sum over points is computed in
/// one direction after the other. For the tangent of 16 functions at 5 x 5 points this takes 80 000
/// multiplications instead of 240 000 for Bᵀ H B point by point.
namespace flexmorph::fem::bending {

/// Number of functions of one coordinate, and number of their derivatives from order 0 on.
inline constexpr int kFunctions = 4, kOrders = 3;
/// Number of table entries per point and direction.
inline constexpr int kLine = kOrders * kFunctions;
inline constexpr int kMaxLine = 16;  ///< Largest number of points per direction.

/// Table of the functions of one coordinate at the points of one direction, entry (point, order of
/// the derivative, function), and of the weights, entry (g, h). T = double: values of one element
/// or of eight equal ones; T = Lanes: values of eight elements.
template <class T>
struct Table {
  int n = 0;                 ///< Number of points per direction, at most kMaxLine.
  std::vector<T> m, across;  ///< Functions along m and along n (n kOrders kFunctions).
  std::vector<T> weight;     ///< Weights of the points (n²).
};

/// Order of the derivative along m and along n of each vector r_m, r_n, r_mm, r_nn, r_mn.
inline constexpr std::array<int, kVectors> kOrderM = {1, 0, 2, 0, 1}, kOrderN = {0, 1, 0, 2, 1};

/// Unknown that belongs to the product of functions i and j: entry 4 j + i; -1: none. Without mixed
/// derivatives (h12) the products of two derivative functions, i and j odd, have none.
using EntryIndices = std::array<int, kFunctions * kFunctions>;

/// View of a table as the kernels read it.
template <class T>
struct TableView {
  int n;  ///< Number of points per direction.
  /// Functions along m, functions along n and weights.
  const T *m, *across, *weight;
};
/// Returns the view of a table.
template <class T>
TableView<T> view(const Table<T>& t) {
  return {t.n, t.m.data(), t.across.data(), t.weight.data()};
}

/// Returns the step between the functions along m that are combined with function j along n:
/// without mixed derivatives the products of two derivative functions do not exist.
template <bool kMixed>
constexpr int step(int j) {
  return kMixed || j % 2 == 0 ? 1 : 2;
}

/// Sorts the unknowns (n_shapes 3) by products of functions: entry 3 (4 j + i) + c.
template <class V>
inline void by_functions(const EntryIndices& value_indices, const V* q, V* x) {
  for (std::size_t k = 0; k < value_indices.size(); ++k)
    for (std::size_t c = 0; c < 3; ++c)
      x[3 * k + c] =
          value_indices[k] < 0 ? V{} : q[3 * static_cast<std::size_t>(value_indices[k]) + c];
}

/// Computes the derivatives along m at one point of the direction m for every function along n:
/// entry 3 (4 order + j) + c.
template <bool kMixed, class V, class T>
inline void along_m(const T* f, const V* x, V* z) {
#pragma GCC unroll 4
  for (int j = 0; j < kFunctions; ++j) {
    V sum[kOrders * 3] = {};
#pragma GCC unroll 4
    for (int i = 0; i < kFunctions; i += step<kMixed>(j))
#pragma GCC unroll 3
      for (int order = 0; order < kOrders; ++order)
#pragma GCC unroll 3
        for (int c = 0; c < 3; ++c)
          sum[3 * order + c] += f[kFunctions * order + i] * x[3 * (kFunctions * j + i) + c];
    for (int order = 0; order < kOrders; ++order)
      for (int c = 0; c < 3; ++c) z[3 * (kFunctions * order + j) + c] = sum[3 * order + c];
  }
}

/// Computes the vectors at a point.
template <class V, class T>
inline void vectors_at(const T* f, const V* z, Vec<V>* y) {
#pragma GCC unroll 5
  for (std::size_t v = 0; v < kVectors; ++v)
#pragma GCC unroll 3
    for (int c = 0; c < 3; ++c) {
      V sum{};
#pragma GCC unroll 4
      for (int j = 0; j < kFunctions; ++j)
        sum += f[kFunctions * kOrderN[v] + j] * z[3 * (kFunctions * kOrderM[v] + j) + c];
      y[v][c] = sum;
    }
}

/// Calls f(h, Point) for all points, one row g after the other, and end(g) after each row.
template <bool kMixed, class V, class T, class F, class End>
inline void for_points(const TableView<T>& t, const EntryIndices& value_indices,
                       const Eigen::Matrix3d& stiffness, const V* q, const F& f, const End& end) {
  V x[3 * kFunctions * kFunctions], z[3 * kLine];
  by_functions(value_indices, q, x);
  for (int g = 0; g < t.n; ++g) {
    along_m<kMixed>(t.m + kLine * g, x, z);
    for (int h = 0; h < t.n; ++h) {
      Vec<V> y[kVectors];
      vectors_at(t.across + kLine * h, z, y);
      f(h, Point<V>(y, stiffness, V{} + t.weight[t.n * g + h]));
    }
    end(g);
  }
}

/// Returns the bending energy of the element.
template <bool kMixed, class V, class T>
inline V energy(const TableView<T>& t, const EntryIndices& value_indices,
                const Eigen::Matrix3d& stiffness, const V* q) {
  V out{};
  for_points<kMixed>(
      t, value_indices, stiffness, q, [&](int, const Point<V>& point) { out += point.energy(); },
      [](int) {});
  return out;
}

/// Adds ∂U/∂q (n_shapes 3).
template <bool kMixed, class V, class T>
inline void add_force(const TableView<T>& t, const EntryIndices& value_indices,
                      const Eigen::Matrix3d& stiffness, const V* q, V* force) {
  V sum[3 * kFunctions * kFunctions] = {};
  Vec<V> row[kMaxLine][kVectors];
  const auto end = [&](int g) {
    for (int c = 0; c < 3; ++c) {
      V z[kLine] = {};  // work on the derivatives along m
      for (int h = 0; h < t.n; ++h) {
        const T* f = t.across + kLine * h;
#pragma GCC unroll 5
        for (std::size_t v = 0; v < kVectors; ++v)
#pragma GCC unroll 4
          for (int j = 0; j < kFunctions; ++j)
            z[kFunctions * kOrderM[v] + j] += f[kFunctions * kOrderN[v] + j] * row[h][v][c];
      }
      const T* f = t.m + kLine * g;
#pragma GCC unroll 4
      for (int j = 0; j < kFunctions; ++j)
#pragma GCC unroll 4
        for (int i = 0; i < kFunctions; i += step<kMixed>(j))
#pragma GCC unroll 3
          for (int order = 0; order < kOrders; ++order)
            sum[3 * (kFunctions * j + i) + c] +=
                f[kFunctions * order + i] * z[kFunctions * order + j];
    }
  };
  for_points<kMixed>(
      t, value_indices, stiffness, q, [&](int h, const Point<V>& point) { point.force(row[h]); },
      end);
  for (std::size_t k = 0; k < value_indices.size(); ++k)
    for (std::size_t c = 0; c < 3; ++c)
      if (value_indices[k] >= 0)
        force[3 * static_cast<std::size_t>(value_indices[k]) + c] += sum[3 * k + c];
}

/// Work space of add_tangent().
template <class V>
struct TangentWork {
  std::vector<Hessian<V>> row;  ///< Second derivatives at the points of one row.
  std::vector<V> blocks;        ///< Sums over the points of every row.
};

/// Sums over h for one pair of coordinate directions at one g: for functions j, l along n and
/// orders a, b of the derivatives along m,
///   out[(16 stride)(4 j + l) + 3 a + b] = Σ_h Σ_v,w f_j H_vw f_l.
template <class V, class T>
inline void sum_across(const TableView<T>& t, const Hessian<V>* row, int entry, std::size_t stride,
                       V* out) {
  V spread[kMaxLine][kVectors][kLine];  // H_vw f_l: order of w along m, l
  for (int h = 0; h < t.n; ++h) {
    const T* f = t.across + kLine * h;
    for (int v = 0; v < kVectors; ++v) {
      V sum[kLine] = {};
#pragma GCC unroll 5
      for (std::size_t w = 0; w < kVectors; ++w) {
        const V x = row[h].at[v][w][entry];
#pragma GCC unroll 4
        for (int l = 0; l < kFunctions; ++l)
          sum[kFunctions * kOrderM[w] + l] += f[kFunctions * kOrderN[w] + l] * x;
      }
      for (int k = 0; k < kLine; ++k) spread[h][v][k] = sum[k];
    }
  }
  const auto block = [&]<int a, int... v>(std::integer_sequence<int, v...>) {
    for (int b = 0; b < kOrders; ++b) {
      V sum[kFunctions * kFunctions] = {};
      for (int h = 0; h < t.n; ++h) {
        const auto add = [&](int vector) {
          const T* f =
              t.across + kLine * h + kFunctions * kOrderN[static_cast<std::size_t>(vector)];
          const V* x = spread[h][vector] + kFunctions * b;
#pragma GCC unroll 4
          for (int j = 0; j < kFunctions; ++j)
#pragma GCC unroll 4
            for (int l = 0; l < kFunctions; ++l) sum[kFunctions * j + l] += f[j] * x[l];
        };
        (add(v), ...);
      }
      for (std::size_t k = 0; k < kFunctions * kFunctions; ++k)
        out[stride * k + static_cast<std::size_t>(kOrders * a + b)] = sum[k];
    }
  };
  block.template operator()<0>(std::integer_sequence<int, 1, 3>{});
  block.template operator()<1>(std::integer_sequence<int, 0, 4>{});
  block.template operator()<2>(std::integer_sequence<int, 2>{});
}

/// Sums over g for functions i, k along m in steps of `rows` and `columns`:
///   out[4 i + k] = Σ_g Σ_a,b f_i^(a) blocks[9 g + 3 a + b] f_k^(b).
template <int rows, int columns, class V, class T>
inline void sum_along(const TableView<T>& t, const V* blocks, V* out) {
  V sum[kFunctions * kFunctions] = {};
  for (int g = 0; g < t.n; ++g, blocks += kOrders * kOrders) {
    const T* f = t.m + kLine * g;
#pragma GCC unroll 4
    for (int k = 0; k < kFunctions; k += columns) {
      V part[kOrders];
#pragma GCC unroll 3
      for (int a = 0; a < kOrders; ++a)
        part[a] = blocks[3 * a] * f[k] + blocks[3 * a + 1] * f[kFunctions + k] +
                  blocks[3 * a + 2] * f[2 * kFunctions + k];
#pragma GCC unroll 4
      for (int i = 0; i < kFunctions; i += rows)
#pragma GCC unroll 3
        for (int a = 0; a < kOrders; ++a)
          sum[kFunctions * i + k] += f[kFunctions * a + i] * part[a];
    }
  }
  for (int k = 0; k < kFunctions * kFunctions; ++k) out[k] = sum[k];
}

/// Adds scale ∂²U/∂q² (n_local x n_local, symmetric).
template <bool kMixed, class V, class T>
inline void add_tangent(const TableView<T>& t, const EntryIndices& value_indices,
                        const Eigen::Matrix3d& stiffness, const V* q, TangentWork<V>& work,
                        V* tangent) {
  constexpr std::size_t kPairs = kFunctions * kFunctions;
  constexpr std::size_t kLocal = 3 * (kMixed ? 16 : 12);
  const std::size_t stride = static_cast<std::size_t>(kOrders * kOrders * t.n);
  work.row.resize(static_cast<std::size_t>(t.n));
  work.blocks.resize(6 * kPairs * stride);
  // Pairs of coordinate directions with row <= column; the other pairs follow by symmetry.
  constexpr std::array<std::size_t, 6> kRow = {0, 0, 0, 1, 1, 2}, kColumn = {0, 1, 2, 1, 2, 2};
  for_points<kMixed>(
      t, value_indices, stiffness, q,
      [&](int h, const Point<V>& point) { point.tangent(work.row[static_cast<std::size_t>(h)]); },
      [&](int g) {
        for (std::size_t p = 0; p < 6; ++p)
          sum_across(t, work.row.data(), static_cast<int>(3 * kRow[p] + kColumn[p]), stride,
                     work.blocks.data() + p * kPairs * stride +
                         static_cast<std::size_t>(kOrders * kOrders * g));
      });
  for (std::size_t p = 0; p < 6; ++p)
    for (int j = 0; j < kFunctions; ++j)
      for (int l = kRow[p] == kColumn[p] ? j : 0; l < kFunctions; ++l) {
        const auto at = static_cast<std::size_t>(kFunctions * j + l);
        const V* blocks = work.blocks.data() + (p * kPairs + at) * stride;
        V sum[kPairs];
        const int rows = step<kMixed>(j), columns = step<kMixed>(l);
        if (rows == 1 && columns == 1)
          sum_along<1, 1>(t, blocks, sum);
        else if (rows == 1)
          sum_along<1, 2>(t, blocks, sum);
        else if (columns == 1)
          sum_along<2, 1>(t, blocks, sum);
        else
          sum_along<2, 2>(t, blocks, sum);
        for (int i = 0; i < kFunctions; i += rows)
          for (int k = 0; k < kFunctions; k += columns) {
            const auto of = [&](int m, int n) {
              return 3 * static_cast<std::size_t>(
                             value_indices[static_cast<std::size_t>(kFunctions * n + m)]);
            };
            const std::size_t row = of(i, j) + kRow[p], column = of(k, l) + kColumn[p];
            const V& value = sum[kFunctions * i + k];
            tangent[column * kLocal + row] += value;
            if (kRow[p] != kColumn[p] || j != l) tangent[row * kLocal + column] += value;
          }
      }
}

}  // namespace flexmorph::fem::bending
