#pragma once

#include <cstddef>

#include "geometry/vector_level.h"

namespace flexmorph::fem {

inline constexpr int kLanes = 8;

/// Vectors of the compiler. (GCC ignores the attribute where its size depends on the template.)
template <int kWidth>
struct VectorOf;
template <>
struct VectorOf<2> {
  using Type = double __attribute__((vector_size(16)));
};
template <>
struct VectorOf<4> {
  using Type = double __attribute__((vector_size(32)));
};
template <>
struct VectorOf<8> {
  using Type = double __attribute__((vector_size(64)));
};

/// One number of each of eight elements: arithmetic works on all of them at once, in vectors of
/// `kWidth` numbers (the vector extension of GCC and Clang). Values are the same for every width,
/// and so is the memory, whose alignment is that of the widest registers: kernels for all
/// processors share it (geometry/vector_level.h).
template <int kWidth>
struct alignas(kLanes * sizeof(double)) [[gnu::may_alias]] LanesOf {
  using Vector = typename VectorOf<kWidth>::Type;
  static constexpr int kParts = kLanes / kWidth;
  Vector part[kParts];

  double& operator[](std::size_t lane) { return reinterpret_cast<double*>(part)[lane]; }
  double operator[](std::size_t lane) const { return reinterpret_cast<const double*>(part)[lane]; }

  LanesOf& operator+=(const LanesOf& x) { return *this = *this + x; }
  LanesOf& operator-=(const LanesOf& x) { return *this = *this - x; }
  LanesOf& operator*=(const LanesOf& x) { return *this = *this * x; }
  LanesOf& operator*=(double x) { return *this = *this * x; }
  LanesOf& operator/=(double x) { return *this = *this / x; }

  friend LanesOf operator-(const LanesOf& x) {
    return by_parts([&](int k) { return -x.part[k]; });
  }
  friend LanesOf operator+(const LanesOf& x, const LanesOf& y) {
    return by_parts([&](int k) { return x.part[k] + y.part[k]; });
  }
  friend LanesOf operator-(const LanesOf& x, const LanesOf& y) {
    return by_parts([&](int k) { return x.part[k] - y.part[k]; });
  }
  friend LanesOf operator*(const LanesOf& x, const LanesOf& y) {
    return by_parts([&](int k) { return x.part[k] * y.part[k]; });
  }
  friend LanesOf operator/(const LanesOf& x, const LanesOf& y) {
    return by_parts([&](int k) { return x.part[k] / y.part[k]; });
  }
  friend LanesOf operator+(const LanesOf& x, double y) {
    return by_parts([&](int k) { return x.part[k] + y; });
  }
  friend LanesOf operator-(const LanesOf& x, double y) {
    return by_parts([&](int k) { return x.part[k] - y; });
  }
  friend LanesOf operator*(const LanesOf& x, double y) {
    return by_parts([&](int k) { return x.part[k] * y; });
  }
  friend LanesOf operator/(const LanesOf& x, double y) {
    return by_parts([&](int k) { return x.part[k] / y; });
  }
  friend LanesOf operator-(double x, const LanesOf& y) {
    return by_parts([&](int k) { return x - y.part[k]; });
  }
  friend LanesOf operator*(double x, const LanesOf& y) { return y * x; }
  friend LanesOf operator/(double x, const LanesOf& y) {
    return by_parts([&](int k) { return x / y.part[k]; });
  }

 private:
  template <class Part>
  static LanesOf by_parts(const Part& of) {
    LanesOf out;
#pragma GCC unroll 8
    for (int k = 0; k < kParts; ++k) out.part[k] = of(k);
    return out;
  }
};

static_assert(sizeof(LanesOf<2>) == 64 && sizeof(LanesOf<4>) == 64 && sizeof(LanesOf<8>) == 64);

/// As all code has them that is no kernel.
using Lanes = LanesOf<2>;

/// The same numbers in vectors of another width.
template <class V>
inline const V* lanes_as(const Lanes* x) {
  return reinterpret_cast<const V*>(x);
}
template <class V>
inline V* lanes_as(Lanes* x) {
  return reinterpret_cast<V*>(x);
}

/// Runs a kernel, which is told its type of lanes: `kernel.template operator()<V>()`.
template <class Kernel>
inline void run_batch_kernel(const Kernel& kernel) {
  run_kernel([&]<int kBytes> {
    kernel.template operator()<LanesOf<kBytes / static_cast<int>(sizeof(double))>>();
  });
}

/// Eight consecutive elements of a body, side by side.
///
/// Unknown dim k + c of an element belongs to its shape function k, direction c. Lanes behind
/// `count` repeat the last element: what is computed for them is not used.
struct Batch {
  int first = 0, count = kLanes;  ///< elements [first, first + count)
  int n_shapes = 0, dim = 0;
  const Lanes *q = nullptr, *v = nullptr, *a = nullptr;  ///< (n_shapes dim) each

  int n_local() const { return n_shapes * dim; }
};

/// Bytes of the registers that numbers of a kernel are in.
template <class V>
inline constexpr int kBytesOf = 16;
template <int kWidth>
inline constexpr int kBytesOf<LanesOf<kWidth>> = kWidth* static_cast<int>(sizeof(double));

}  // namespace flexmorph::fem
