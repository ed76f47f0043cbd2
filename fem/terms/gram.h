#pragma once

#include <array>
#include <cstddef>

#include "fem/shapes/batch.h"

/// Kernels of the Gram form of the in-plane elastic force (fem/terms/membrane.cpp), for one element
/// (V = double) or eight of them side by side (V = LanesOf<...>).
///
/// With vectors p_i, g_ij = p_i·p_j (i < j) and g_ii = ½ p_i·p_i, U = ½ (g - g°)ᵀ W (g - g°):
///
///   s = W (g - g°),   force F_k = Σ_l s_kl p_l
///   tangent K_(kb),(lc) = s_kl δ_bc + Σ_ij p_ib W_(ki),(lj) p_jc
///
/// The vectors are not the nodal ones but sums and differences of them that are even or odd in each
/// of the two directions of the element: of four classes. A pair of vectors is of a class in turn,
/// and W couples pairs of different classes only where material varies inside the element. In all
/// others it falls into four blocks, a quarter of the operations.
namespace flexmorph::fem::gram {

/// Numbering for elements with kKinds vectors at each of four nodes: 1 (r), 3 (r, r_m, r_n) or 4
/// (r_mn).
///
/// Class of a vector: 1 if odd along m, plus 2 if odd along n; of a pair: that of its product. The
/// even-even vector of the positions is a translation, which strains nothing: it is left out.
template <int kKinds>
struct Numbering {
  static constexpr int n = 4 * kKinds - 1, n_pairs = n * (n + 1) / 2;
  static constexpr std::array<int, 5> first = {0, kKinds - 1, 2 * kKinds - 1, 3 * kKinds - 1, n};

  /// Vector of a kind and class, -1: the translation.
  static constexpr int vector(int kind, int c) {
    return c == 0 ? kind - 1 : first[static_cast<std::size_t>(c)] + kind;
  }

  struct Tables {
    std::array<int, n_pairs> i{}, j{};         ///< i <= j of every pair
    std::array<int, 5> start{};                ///< pairs by classes
    std::array<std::array<int, n>, n> pair{};  ///< number of {i, j}
    std::array<int, n> vector_class{};
  };
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
  static constexpr Tables tables = make();
};

/// Which pairs W couples: all, or only those of one class.
enum class Coupling { all, classes };

/// Numbers that store a block of m pairs: its lower triangle by rows, or a full square.
constexpr int packed(int m) { return m * (m + 1) / 2; }
constexpr int square(int m) { return m * m; }

/// Numbers that store W: of all pairs, or of its four blocks.
template <int kKinds>
constexpr int n_stored(Coupling coupling, int (*size)(int)) {
  using N = Numbering<kKinds>;
  if (coupling == Coupling::all) return size(N::n_pairs);
  int n = 0;
  for (std::size_t c = 0; c < 4; ++c) n += size(N::tables.start[c + 1] - N::tables.start[c]);
  return n;
}

/// W of eight different elements.
template <class V>
struct Different {
  const V* w;
  static constexpr auto size = packed;
  V at(int x, int y, int) const { return w[x >= y ? x * (x + 1) / 2 + y : y * (y + 1) / 2 + x]; }
  Different behind(int n) const { return {w + n}; }
};
/// W of one of them.
struct OneOf {
  const Lanes* w;
  int lane;
  static constexpr auto size = packed;
  double at(int x, int y, int) const {
    return w[x >= y ? x * (x + 1) / 2 + y : y * (y + 1) / 2 + x][static_cast<std::size_t>(lane)];
  }
  OneOf behind(int n) const { return {w + n, lane}; }
};
/// One W for all elements: small enough for the first cache as squares.
struct Shared {
  const double* w;
  static constexpr auto size = square;
  double at(int x, int y, int m) const { return w[x * m + y]; }
  Shared behind(int n) const { return {w + n}; }
};

/// Sums and differences of the ends of an interval: even and odd parts of a value, or of a slope.
template <class V>
inline void split(bool slope, const V& x0, const V& x1, V& even, V& odd) {
  even = slope ? x0 - x1 : x0 + x1;
  odd = slope ? x0 + x1 : x1 - x0;
}
/// Transposed.
template <class V>
inline void join(bool slope, const V& even, const V& odd, V& x0, V& x1) {
  x0 = slope ? even + odd : even - odd;
  x1 = slope ? odd - even : even + odd;
}
constexpr bool slope_m(int kind) { return kind == 1 || kind == 3; }
constexpr bool slope_n(int kind) { return kind >= 2; }

/// The vectors p (n x dim) of nodal ones q (4 kKinds x dim), corners (0,0), (1,0), (1,1), (0,1).
template <int kKinds, int kDim, class V>
inline void vectors(const V* q, V* p) {
  using N = Numbering<kKinds>;
  constexpr int kNode = kKinds * kDim;
  for (int kind = 0; kind < kKinds; ++kind)
    for (int c = 0; c < kDim; ++c) {
      const V* x = q + kind * kDim + c;
      // Positions relative to one of them: no digits are lost far from the origin.
      const V origin = kind == 0 ? x[0] : x[0] - x[0];
      V e0, o0, e1, o1, part[4];
      split<V>(slope_m(kind), x[0] - origin, x[kNode] - origin, e0, o0);
      split<V>(slope_m(kind), x[3 * kNode] - origin, x[2 * kNode] - origin, e1, o1);
      split<V>(slope_n(kind), e0, e1, part[0], part[2]);
      split<V>(slope_n(kind), o0, o1, part[1], part[3]);
      for (int k = kind == 0 ? 1 : 0; k < 4; ++k) p[N::vector(kind, k) * kDim + c] = 0.25 * part[k];
    }
}

/// g_ij = p_i·p_j, g_ii = ½ p_i·p_i.
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

/// s = W g of one block of m pairs.
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

/// s = W g. One copy for all that need it.
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

/// Adds the force (n x dim) at the vectors to that at the nodes (4 kKinds x dim).
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

/// Adds F (4 kKinds x dim) of the stress s to the nodal force.
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

/// Pairs (k, j), k of class a and j of class b >= a: T = rows of W D(right), then D(left)ᵀ T into
/// `stiffness`: blocks k <= l where left and right are the same (kSymmetric), else all.
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
  // The block of W: its first pair, its size.
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

  // K_(kb),(lc) += Σ_j p_jb T_(kj),(lc), and the same with k and j swapped.
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

/// S ⊗ 1 + D(left)ᵀ W D(right) at the vectors: dim x dim blocks k <= l of them, or all.
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
      // Positions alone have no vector of the class that is even both ways.
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

/// Adds weight times the stiffness at the vectors to the nodal tangent (4 kKinds dim)², by columns:
/// of two kinds, four classes by four classes become four corners by four corners.
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
