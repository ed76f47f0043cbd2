#pragma once

#include <array>
#include <cstddef>

#include "fem/shapes/batch.h"

/// Kernels of the Gram form of the in-plane elastic force (fem/terms/membrane.cpp), for one element
/// (V = double) or eight elements side by side (V = PackOf<...>).
///
/// With vectors p_i, g_ij = p_i·p_j (i < j) and g_ii = ½ p_i·p_i, U = ½ (g - g°)ᵀ W (g - g°):
///
///   s = W (g - g°),   force F_k = Σ_l s_kl p_l
///   tangent K_(kb),(lc) = s_kl δ_bc + Σ_ij p_ib W_(ki),(lj) p_jc
///
/// The vectors are not the nodal ones but their sums and differences, which are even or odd in each
/// of the two directions of the element. They form four classes. A pair of vectors belongs to a
/// class, too, and W couples pairs of different classes only where material varies inside the
/// element. Otherwise W consists of four blocks, which takes a quarter of the operations.
namespace flexmorph::fem::gram {

/// Numbering of vectors and pairs for elements with kKinds vectors at each of four nodes: 1 (r), 3
/// (r, r_m, r_n) or 4 (with r_mn).
///
/// A vector has class 1 if it is odd along m, plus 2 if it is odd along n; a pair has the class of
/// its product. The even-even vector of the positions is a translation without strain and is left
/// out.
template <int kKinds>
struct Numbering {
  /// Number of vectors and number of pairs.
  static constexpr int n = 4 * kKinds - 1, n_pairs = n * (n + 1) / 2;
  /// First vector of each class; the last entry is the number of vectors.
  static constexpr std::array<int, 5> first = {0, kKinds - 1, 2 * kKinds - 1, 3 * kKinds - 1, n};

  /// Returns the number of the vector of a kind and class; -1 for the translation.
  static constexpr int vector(int kind, int c) {
    return c == 0 ? kind - 1 : first[static_cast<std::size_t>(c)] + kind;
  }

  /// Tables of the pairs of vectors.
  struct Tables {
    std::array<int, n_pairs> i{}, j{};         ///< Vectors i <= j of every pair.
    std::array<int, 5> start{};                ///< First pair of each class.
    std::array<std::array<int, n>, n> pair{};  ///< Number of the pair {i, j}.
    std::array<int, n> vector_class{};         ///< Class of every vector.
  };
  /// Returns the tables of this numbering.
  static constexpr Tables make() {
    Tables t;
    int at = 0;
    for (std::size_t c = 0; c < 4; ++c) {
      t.start[c] = at;
      for (int v = first[c]; v < first[c + 1]; ++v)
        t.vector_class[static_cast<std::size_t>(v)] = static_cast<int>(c);
      for (std::size_t a = 0; a < 4; ++a) {
        const std::size_t b = a ^ c;
        if (b < a) continue;
        for (int i = first[a]; i < first[a + 1]; ++i)
          for (int j = a == b ? i : first[b]; j < first[b + 1]; ++j, ++at) {
            const auto x = static_cast<std::size_t>(i), y = static_cast<std::size_t>(j);
            t.i[static_cast<std::size_t>(at)] = i;
            t.j[static_cast<std::size_t>(at)] = j;
            t.pair[x][y] = t.pair[y][x] = at;
          }
      }
    }
    t.start[4] = at;
    return t;
  }
  static constexpr Tables tables = make();  ///< Tables of this numbering.
};

/// Pairs that W couples: all, or only those of one class.
enum class Coupling { all, classes };

/// Returns the number of entries of the lower triangle of a block of m pairs, stored by rows.
constexpr int packed(int m) { return m * (m + 1) / 2; }
/// Returns the number of entries of the full square of a block of m pairs.
constexpr int square(int m) { return m * m; }

/// W of eight different elements.
template <class V>
struct Different {
  const V* w;                           ///< Packed entries.
  static constexpr auto size = packed;  ///< Number of entries of a block of m pairs.
  /// Returns the entry of two pairs of the block.
  V at(int x, int y, int) const { return w[x >= y ? x * (x + 1) / 2 + y : y * (y + 1) / 2 + x]; }
  Different behind(int n) const { return {w + n}; }  ///< Returns the view n entries later.
};
/// W of one of eight elements.
struct OneOf {
  const Pack* w;                        ///< Packed entries of eight elements.
  int lane;                             ///< SIMD lane of the element.
  static constexpr auto size = packed;  ///< Number of entries of a block of m pairs.
  /// Returns the entry of two pairs of the block.
  double at(int x, int y, int) const {
    return w[x >= y ? x * (x + 1) / 2 + y : y * (y + 1) / 2 + x][static_cast<std::size_t>(lane)];
  }
  OneOf behind(int n) const { return {w + n, lane}; }  ///< Returns the view n entries later.
};
/// One W for all elements, stored as squares; it is small enough for the first-level cache.
struct Shared {
  const double* w;                      ///< Entries by rows.
  static constexpr auto size = square;  ///< Number of entries of a block of m pairs.
  double at(int x, int y, int m) const { return w[x * m + y]; }  ///< Returns an entry of W.
  Shared behind(int n) const { return {w + n}; }  ///< Returns the view n entries later.
};

/// Splits a function into its even and odd part, given its end values or end derivatives (slope).
template <class V>
inline void split(bool slope, const V& x0, const V& x1, V& even, V& odd) {
  even = slope ? x0 - x1 : x0 + x1;
  odd = slope ? x0 + x1 : x1 - x0;
}
/// Applies the transposed operation of split().
template <class V>
inline void join(bool slope, const V& even, const V& odd, V& x0, V& x1) {
  x0 = slope ? even + odd : even - odd;
  x1 = slope ? odd - even : even + odd;
}
/// Returns true if the vectors of a kind are derivatives along m.
constexpr bool slope_m(int kind) { return kind == 1 || kind == 3; }
constexpr bool slope_n(int kind) { return kind >= 2; }  ///< Returns true for derivatives along n.

/// Computes p (n x dim) from nodal vectors q (4 kKinds x dim), corners (0,0), (1,0), (1,1), (0,1).
template <int kKinds, int kDim, class V>
inline void vectors(const V* q, V* p) {
  using N = Numbering<kKinds>;
  constexpr int kNode = kKinds * kDim;
  for (int kind = 0; kind < kKinds; ++kind)
    for (int c = 0; c < kDim; ++c) {
      const V* x = q + kind * kDim + c;
      // Positions relative to the first one, so that no digits are lost far from the origin.
      const V origin = kind == 0 ? x[0] : x[0] - x[0];
      V e0, o0, e1, o1, part[4];
      split<V>(slope_m(kind), x[0] - origin, x[kNode] - origin, e0, o0);
      split<V>(slope_m(kind), x[3 * kNode] - origin, x[2 * kNode] - origin, e1, o1);
      split<V>(slope_n(kind), e0, e1, part[0], part[2]);
      split<V>(slope_n(kind), o0, o1, part[1], part[3]);
      for (int k = kind == 0 ? 1 : 0; k < 4; ++k) p[N::vector(kind, k) * kDim + c] = 0.25 * part[k];
    }
}

/// Computes the products g_ij = p_i·p_j, g_ii = ½ p_i·p_i.
template <int kKinds, int kDim, class V>
inline void products(const V* p, V* g) {
  using N = Numbering<kKinds>;
  for (int at = 0; at < N::n_pairs; ++at) {
    const auto k = static_cast<std::size_t>(at);
    const V *x = p + N::tables.i[k] * kDim, *y = p + N::tables.j[k] * kDim;
    V sum = x[0] * y[0];
    for (int c = 1; c < kDim; ++c) sum += x[c] * y[c];
    g[at] = x == y ? 0.5 * sum : sum;
  }
}

/// Computes s = W g of one block of m pairs.
template <int m, class V, class W>
inline void multiply_block(W w, const V* g, V* s) {
  for (int r = 0; r < m; ++r) {
    V sum{};
    const V gr = g[r];
    for (int t = 0; t < r; ++t) {
      const auto entry = w.at(r, t, m);
      sum += entry * g[t];
      s[t] += entry * gr;
    }
    s[r] = sum + w.at(r, r, m) * gr;
  }
}
/// Computes s = W g of one block of m pairs that is stored as a full square.
template <int m, class V>
inline void multiply_block(Shared w, const V* g, V* s) {
  constexpr int kRows = m % 7 == 0 ? 7 : m % 6 == 0 ? 6 : m % 5 == 0 ? 5 : m;
  static_assert(m % kRows == 0);
  for (int r = 0; r < m; r += kRows) {
    V sum[kRows] = {};
    for (int t = 0; t < m; ++t) {
      const V gt = g[t];
#pragma GCC unroll 8
      for (int k = 0; k < kRows; ++k) sum[k] += w.w[t * m + r + k] * gt;
    }
    for (int k = 0; k < kRows; ++k) s[r + k] = sum[k];
  }
}

/// Computes s = W g. All callers share one compiled copy.
template <int kKinds, Coupling coupling, class V, class W>
inline void multiply(W all, const V* g, V* s) {
  run_kernel_part<kBytesOf<V>>([=] {
    constexpr auto& start = Numbering<kKinds>::tables.start;
    if constexpr (coupling == Coupling::all) {
      multiply_block<start[4]>(all, g, s);
    } else {
      W w = all;
      const auto block = [&]<std::size_t c>() {
        constexpr int m = start[c + 1] - start[c];
        multiply_block<m>(w, g + start[c], s + start[c]);
        w = w.behind(W::size(m));
      };
      block.template operator()<0>();
      block.template operator()<1>();
      block.template operator()<2>();
      block.template operator()<3>();
    }
  });
}

/// Adds the force (n x dim) on the vectors to the force on the nodes (4 kKinds x dim).
template <int kKinds, int kDim, class V>
inline void add_to_nodes(const V* f, V* force) {
  using N = Numbering<kKinds>;
  constexpr int kNode = kKinds * kDim;
  for (int kind = 0; kind < kKinds; ++kind)
    for (int c = 0; c < kDim; ++c) {
      V part[4] = {};
      for (int k = kind == 0 ? 1 : 0; k < 4; ++k) part[k] = f[N::vector(kind, k) * kDim + c];
      V e0, o0, e1, o1, x[4];
      join(slope_n(kind), part[0], part[2], e0, e1);
      join(slope_n(kind), part[1], part[3], o0, o1);
      join(slope_m(kind), e0, o0, x[0], x[1]);
      join(slope_m(kind), e1, o1, x[3], x[2]);
      for (int corner = 0; corner < 4; ++corner)
        force[corner * kNode + kind * kDim + c] += x[corner];
    }
}

/// Adds the force F (4 kKinds x dim) of the stress s to the nodal force.
template <int kKinds, int kDim, class V>
inline void add_force(const V* s, const V* p, V* force) {
  using N = Numbering<kKinds>;
  V f[N::n * kDim];
  for (int k = 0; k < N::n; ++k) {
    V sum[kDim] = {};
    for (int l = 0; l < N::n; ++l) {
      const V skl = s[N::tables.pair[static_cast<std::size_t>(k)][static_cast<std::size_t>(l)]];
      for (int c = 0; c < kDim; ++c) sum[c] += skl * p[l * kDim + c];
    }
    for (int c = 0; c < kDim; ++c) f[k * kDim + c] = 0.25 * sum[c];
  }
  add_to_nodes<kKinds, kDim>(f, force);
}

/// Adds D(left)ᵀ T, T = W D(right), for the pairs (k, j), k of class a and j of class b >= a, to
/// `stiffness`: blocks k <= l if left and right are equal (kSymmetric), otherwise all blocks.
template <int kKinds, int kDim, Coupling coupling, int a, int b, bool kSymmetric, class V, class W>
inline void add_pairs(W w, const V* left, const V* right, V* stiffness) {
  using N = Numbering<kKinds>;
  constexpr auto& t = N::tables;
  constexpr int n = N::n, kClass = a ^ b;
  constexpr int kFirst = N::first[a], kEnd = N::first[a + 1], jFirst = N::first[b],
                jEnd = N::first[b + 1];
  constexpr int kStart = t.pair[kFirst][jFirst];
  constexpr int kRows =
      a == b ? (kEnd - kFirst) * (kEnd - kFirst + 1) / 2 : (kEnd - kFirst) * (jEnd - jFirst);
  // First pair and size of the block of W.
  constexpr int kBase = coupling == Coupling::all ? 0 : t.start[kClass];
  constexpr int m = coupling == Coupling::all ? N::n_pairs : t.start[kClass + 1] - kBase;
  V rows[kRows * n * kDim];
  for (int r = 0; r < kRows; ++r)
    for (int l = 0; l < n; ++l) {
      const auto ul = static_cast<std::size_t>(l);
      V sum[kDim] = {};
      const auto add = [&]<int count>(int i) {
#pragma GCC unroll 16
        for (int step = 0; step < count; ++step, ++i) {
          const auto entry =
              w.at(kStart + r - kBase, t.pair[ul][static_cast<std::size_t>(i)] - kBase, m);
          for (int c = 0; c < kDim; ++c) sum[c] += entry * right[i * kDim + c];
        }
      };
      if constexpr (coupling == Coupling::all) {
        add.template operator()<n>(0);
      } else {
        const int partner = t.vector_class[ul] ^ kClass;
        if (partner == 0)
          add.template operator()<kKinds - 1>(0);
        else
          add.template operator()<kKinds>(N::first[static_cast<std::size_t>(partner)]);
      }
      for (int c = 0; c < kDim; ++c) rows[(r * n + l) * kDim + c] = sum[c];
    }

  // K_(kb),(lc) += Σ_j p_jb T_(kj),(lc), and again with k and j swapped.
  const auto gather = [&](int k, int from, int to) {
    for (int l = kSymmetric ? k : 0; l < n; ++l) {
      V* out = stiffness + (k * n + l) * kDim * kDim;
      V sum[kDim * kDim];
      for (int x = 0; x < kDim * kDim; ++x) sum[x] = out[x];
      for (int j = from; j < to; ++j) {
        const int r = t.pair[static_cast<std::size_t>(k)][static_cast<std::size_t>(j)] - kStart;
        const V *row = rows + (r * n + l) * kDim, *y = left + j * kDim;
        for (int x = 0; x < kDim; ++x)
          for (int c = 0; c < kDim; ++c) sum[x * kDim + c] += y[x] * row[c];
      }
      for (int x = 0; x < kDim * kDim; ++x) out[x] = sum[x];
    }
  };
  for (int k = kFirst; k < kEnd; ++k) gather(k, jFirst, jEnd);
  if constexpr (a != b)
    for (int j = jFirst; j < jEnd; ++j) gather(j, kFirst, kEnd);
}

/// Computes S ⊗ 1 + D(left)ᵀ W D(right) of the vectors: dim x dim blocks k <= l, or all blocks.
template <int kKinds, int kDim, Coupling coupling, bool kSymmetric, class V, class W>
inline void stiffness_of(W w, const V* s, const V* left, const V* right, V* stiffness) {
  using N = Numbering<kKinds>;
  constexpr auto& t = N::tables;
  constexpr int n = N::n, kSquare = kDim * kDim;
  for (int k = 0; k < n; ++k)
    for (int l = kSymmetric ? k : 0; l < n; ++l)
      for (int x = 0; x < kDim; ++x)
        for (int c = 0; c < kDim; ++c)
          stiffness[(k * n + l) * kSquare + x * kDim + c] =
              x == c ? s[t.pair[static_cast<std::size_t>(k)][static_cast<std::size_t>(l)]] : V{};

  const auto block = [&]<int c>() {
    const auto part = [&]<int a>() {
      // With positions only there is no vector of the class that is even in both directions.
      if constexpr ((a ^ c) >= a && N::first[a] < N::first[a + 1])
        add_pairs<kKinds, kDim, coupling, a, (a ^ c), kSymmetric>(w, left, right, stiffness);
    };
    part.template operator()<0>();
    part.template operator()<1>();
    part.template operator()<2>();
    part.template operator()<3>();
    if (coupling == Coupling::classes) w = w.behind(W::size(t.start[c + 1] - t.start[c]));
  };
  block.template operator()<0>();
  block.template operator()<1>();
  block.template operator()<2>();
  block.template operator()<3>();
}

/// Adds weight times the stiffness of the vectors to the nodal tangent (4 kKinds dim)², by columns:
/// for two kinds, four classes by four classes are mapped to four corners by four corners.
template <int kKinds, int kDim, bool kSymmetric, class V>
inline void add_to_nodes(const V* stiffness, double weight, V* tangent) {
  using N = Numbering<kKinds>;
  constexpr int n = N::n, kSquare = kDim * kDim;
  constexpr int kNode = kKinds * kDim, kLocal = 4 * kNode;
  const double scale = weight / 16;
  for (int kind = 0; kind < kKinds; ++kind)
    for (int other = kSymmetric ? kind : 0; other < kKinds; ++other)
      for (int x = 0; x < kDim; ++x)
        for (int c = 0; c < kDim; ++c) {
          V half[4][4];
          for (int i = 0; i < 4; ++i) {
            V part[4];
            for (int j = 0; j < 4; ++j) {
              const int k = N::vector(kind, i), l = N::vector(other, j);
              part[j] = (kind == 0 && i == 0) || (other == 0 && j == 0) ? V{}
                        : !kSymmetric || k <= l ? stiffness[(k * n + l) * kSquare + x * kDim + c]
                                                : stiffness[(l * n + k) * kSquare + c * kDim + x];
            }
            V e0, o0, e1, o1;
            join(slope_n(other), part[0], part[2], e0, e1);
            join(slope_n(other), part[1], part[3], o0, o1);
            join(slope_m(other), e0, o0, half[i][0], half[i][1]);
            join(slope_m(other), e1, o1, half[i][3], half[i][2]);
          }
          for (int j = 0; j < 4; ++j) {
            V e0, o0, e1, o1, node[4];
            join(slope_n(kind), half[0][j], half[2][j], e0, e1);
            join(slope_n(kind), half[1][j], half[3][j], o0, o1);
            join(slope_m(kind), e0, o0, node[0], node[1]);
            join(slope_m(kind), e1, o1, node[3], node[2]);
            const int column = j * kNode + other * kDim + c;
            for (int i = 0; i < 4; ++i) {
              const int row = i * kNode + kind * kDim + x;
              const V value = scale * node[i];
              tangent[column * kLocal + row] += value;
              if (kSymmetric && kind != other) tangent[row * kLocal + column] += value;
            }
          }
        }
}

/// Adds weight (S ⊗ 1 + D(left)ᵀ W D(right)) to the nodal tangent (4 kKinds dim)², by columns.
template <int kKinds, int kDim, Coupling coupling, bool kSymmetric = true, class V, class W>
inline void add_tangent(W w, const V* s, const V* left, const V* right, double weight, V* tangent) {
  run_kernel_part<kBytesOf<V>>([=] {
    constexpr int n = Numbering<kKinds>::n;
    V stiffness[n * n * kDim * kDim];
    stiffness_of<kKinds, kDim, coupling, kSymmetric>(w, s, left, right, stiffness);
    add_to_nodes<kKinds, kDim, kSymmetric>(stiffness, weight, tangent);
  });
}

}  // namespace flexmorph::fem::gram
