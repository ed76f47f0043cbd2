#pragma once

#include <array>

#include "fem/element.h"

/// The Gram form of a planar beam (beam.cpp): U = ½ (g - g°)ᵀ W (g - g°), where g contains the
/// products of five vectors of an element.
///
///   p (5 x 2)     vectors; W by [J per product²], packed as a lower triangle; s = W (g - g°)
///   V             double, or Lanes for elements side by side
namespace flexmorph::fem::beam_gram {

/// Number of vectors of an element, dimension of the plane and number of shape functions.
inline constexpr int kVectors = 5, kDim = 2, kShapes = 6;
/// Number of products of two vectors.
inline constexpr int kPairs = kVectors * (kVectors + 1) / 2;

/// Returns the number of the pair i, j in the order 00, 10, 11, 20, ...
constexpr int pair(int i, int j) { return i >= j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i; }

/// Index of W for the pairs x and (l, j) in its packed lower triangle: kIndex[x][l][j].
inline constexpr auto kIndex = [] {
  std::array<std::array<std::array<int, kVectors>, kVectors>, kPairs> out{};
  for (int x = 0; x < kPairs; ++x)
    for (int l = 0; l < kVectors; ++l)
      for (int j = 0; j < kVectors; ++j)
        out[static_cast<size_t>(x)][static_cast<size_t>(l)][static_cast<size_t>(j)] =
            pair(x, pair(l, j));
  return out;
}();

/// Computes the vectors p from the nodal ones (r¹ r_x¹ r_y¹ r² r_x² r_y²): r² - r¹, r_x¹, r_y¹,
/// r_x², r_y². Rigid translations cause no strain, and no digits are lost far from the origin.
template <class V>
void vectors(const V* q, V* p) {
  for (int c = 0; c < kDim; ++c) {
    p[c] = q[3 * kDim + c] - q[c];
    p[kDim + c] = q[kDim + c];
    p[2 * kDim + c] = q[2 * kDim + c];
    p[3 * kDim + c] = q[4 * kDim + c];
    p[4 * kDim + c] = q[5 * kDim + c];
  }
}
/// Shape function to which vector k contributes with +1; vector 0 also contributes to shape
/// function 0, with -1.
inline constexpr std::array<int, kVectors> kShapeOf = {3, 1, 2, 4, 5};

/// Computes the products g_ij = p_i · p_j (i ≠ j), g_ii = ½ p_i · p_i.
template <class V>
void products(const V* p, V* g) {
  for (int i = 0; i < kVectors; ++i)
    for (int j = 0; j <= i; ++j) {
      const V sum = p[i * kDim] * p[j * kDim] + p[i * kDim + 1] * p[j * kDim + 1];
      g[pair(i, j)] = i == j ? 0.5 * sum : sum;
    }
}

/// Computes s = W (g - g°), with W packed as a lower triangle.
template <class V>
void stress(const V* w, const V* reference, const V* g, V* s) {
  V change[kPairs];
  for (int k = 0; k < kPairs; ++k) change[k] = g[k] - reference[k];
  for (int r = 0; r < kPairs; ++r) {
    const V* row = w + r * (r + 1) / 2;
    V sum{};
    for (int t = 0; t < r; ++t) {
      sum += row[t] * change[t];
      s[t] += row[t] * change[r];
    }
    s[r] = sum + row[r] * change[r];
  }
}

/// Adds the force F_k = Σ_l s_kl p_l.
template <class V>
void add_force_of(const V* s, const V* p, V* force) {
  for (int k = 0; k < kVectors; ++k)
    for (int c = 0; c < kDim; ++c) {
      V sum{};
      for (int l = 0; l < kVectors; ++l) sum += s[pair(k, l)] * p[l * kDim + c];
      force[kShapeOf[static_cast<size_t>(k)] * kDim + c] += sum;
      if (k == 0) force[c] -= sum;
    }
}

/// Access to the entries of a tangent (kShapes kDim)² that is stored by rows.
struct ByRows {
  double* data;  ///< First entry of the tangent.
  /// Returns the entry of a row and a column.
  double& operator()(int row, int column) const { return data[row * kShapes * kDim + column]; }
};

/// Adds weight (s_kl δ_bc + Σ_ij left_ib W_(ki),(lj) right_jc) at entry(row, column).
template <class V, class Entry>
void add_tangent_of(const V* w, const V* s, const V* left, const V* right, double weight,
                    const Entry& entry) {
  V rows[kPairs][kVectors * kDim];  // Σ_j W_(pair),(lj) right_jc
  for (size_t x = 0; x < kPairs; ++x)
    for (size_t l = 0; l < kVectors; ++l) {
      V sum[kDim] = {};
#pragma GCC unroll 5
      for (size_t j = 0; j < kVectors; ++j) {
        const V value = w[kIndex[x][l][j]];
        for (size_t c = 0; c < kDim; ++c) sum[c] += value * right[j * kDim + c];
      }
      for (size_t c = 0; c < kDim; ++c) rows[x][l * kDim + c] = sum[c];
    }
  for (int k = 0; k < kVectors; ++k)
    for (int l = 0; l < kVectors; ++l) {
      V block[kDim][kDim] = {};
#pragma GCC unroll 5
      for (int i = 0; i < kVectors; ++i) {
        const V* row = rows[pair(k, i)] + l * kDim;
        for (int b = 0; b < kDim; ++b)
          for (int c = 0; c < kDim; ++c) block[b][c] += left[i * kDim + b] * row[c];
      }
      const int first = kShapeOf[static_cast<size_t>(k)] * kDim,
                other = kShapeOf[static_cast<size_t>(l)] * kDim;
      for (int b = 0; b < kDim; ++b)
        for (int c = 0; c < kDim; ++c) {
          const V value = weight * (b == c ? block[b][c] + s[pair(k, l)] : block[b][c]);
          entry(first + b, other + c) += value;
          if (k == 0) entry(b, other + c) -= value;
          if (l == 0) entry(first + b, c) -= value;
          if (k == 0 && l == 0) entry(b, c) += value;
        }
    }
}

}  // namespace flexmorph::fem::beam_gram
