#pragma once

#include <cstddef>

#include "geometry/vector_level.h"

namespace flexmorph::fem {

/// Number of SIMD lanes of a pack, which is the number of elements that are evaluated at once.
inline constexpr int kLanes = 8;

/// Vector type of the compiler with kWidth numbers. The specializations spell out the sizes,
/// because GCC ignores the attribute where its size depends on a template parameter.
template <int kWidth>
struct VectorOf;
/// Vector type of 2 numbers (16 bytes).
template <>
struct VectorOf<2> {
  /// Vector of 2 numbers.
  using Type = double __attribute__((vector_size(16)));
};
/// Vector type of 4 numbers (32 bytes).
template <>
struct VectorOf<4> {
  /// Vector of 4 numbers.
  using Type = double __attribute__((vector_size(32)));
};
/// Vector type of 8 numbers (64 bytes).
template <>
struct VectorOf<8> {
  /// Vector of 8 numbers.
  using Type = double __attribute__((vector_size(64)));
};

/// A pack with one number of each of eight elements. Arithmetic works on all of them at once, in
/// vectors of `kWidth` numbers (the vector extension of GCC and Clang). Values and memory layout
/// are independent of the width, and the alignment fits the widest registers; therefore kernels for
/// all processors share the memory (geometry/vector_level.h).
template <int kWidth>
struct alignas(kLanes * sizeof(double)) [[gnu::may_alias]] PackOf {
  /// Vector type of the compiler.
  using Vector = typename VectorOf<kWidth>::Type;
  static constexpr int kParts = kLanes / kWidth;  ///< Number of vectors in a pack.
  Vector part[kParts];                            ///< The vectors of the pack.

  /// Returns the number in one SIMD lane.
  double& operator[](std::size_t lane) { return reinterpret_cast<double*>(part)[lane]; }
  double operator[](std::size_t lane) const { return reinterpret_cast<const double*>(part)[lane]; }

  /// Adds a pack lane by lane.
  PackOf& operator+=(const PackOf& x) { return *this = *this + x; }
  /// Subtracts a pack lane by lane.
  PackOf& operator-=(const PackOf& x) { return *this = *this - x; }
  /// Multiplies by a pack lane by lane.
  PackOf& operator*=(const PackOf& x) { return *this = *this * x; }
  /// Multiplies all lanes by a number.
  PackOf& operator*=(double x) { return *this = *this * x; }
  /// Divides by a pack lane by lane.
  PackOf& operator/=(double x) { return *this = *this / x; }

  friend PackOf operator-(const PackOf& x) {
    return by_parts([&](int k) { return -x.part[k]; });
  }
  friend PackOf operator+(const PackOf& x, const PackOf& y) {
    return by_parts([&](int k) { return x.part[k] + y.part[k]; });
  }
  friend PackOf operator-(const PackOf& x, const PackOf& y) {
    return by_parts([&](int k) { return x.part[k] - y.part[k]; });
  }
  friend PackOf operator*(const PackOf& x, const PackOf& y) {
    return by_parts([&](int k) { return x.part[k] * y.part[k]; });
  }
  friend PackOf operator/(const PackOf& x, const PackOf& y) {
    return by_parts([&](int k) { return x.part[k] / y.part[k]; });
  }
  friend PackOf operator+(const PackOf& x, double y) {
    return by_parts([&](int k) { return x.part[k] + y; });
  }
  friend PackOf operator-(const PackOf& x, double y) {
    return by_parts([&](int k) { return x.part[k] - y; });
  }
  friend PackOf operator*(const PackOf& x, double y) {
    return by_parts([&](int k) { return x.part[k] * y; });
  }
  friend PackOf operator/(const PackOf& x, double y) {
    return by_parts([&](int k) { return x.part[k] / y; });
  }
  friend PackOf operator-(double x, const PackOf& y) {
    return by_parts([&](int k) { return x - y.part[k]; });
  }
  friend PackOf operator*(double x, const PackOf& y) { return y * x; }
  friend PackOf operator/(double x, const PackOf& y) {
    return by_parts([&](int k) { return x / y.part[k]; });
  }

 private:
  template <class Part>
  static PackOf by_parts(const Part& of) {
    PackOf out;
#pragma GCC unroll 8
    for (int k = 0; k < kParts; ++k) out.part[k] = of(k);
    return out;
  }
};

static_assert(sizeof(PackOf<2>) == 64 && sizeof(PackOf<4>) == 64 && sizeof(PackOf<8>) == 64);

/// Pack in the width that all code except kernels uses.
using Pack = PackOf<2>;

/// Returns the same packs as packs of another vector width.
template <class V>
inline const V* packs_as(const Pack* x) {
  return reinterpret_cast<const V*>(x);
}
template <class V>
inline V* packs_as(Pack* x) {
  return reinterpret_cast<V*>(x);
}

/// Runs a kernel for the vector width of the processor; the kernel receives the type of its packs:
/// `kernel.template operator()<V>()`.
template <class Kernel>
inline void run_batch_kernel(const Kernel& kernel) {
  run_kernel([&]<int kBytes> {
    kernel.template operator()<PackOf<kBytes / static_cast<int>(sizeof(double))>>();
  });
}

/// The unknowns of eight consecutive elements of a body, one element per SIMD lane.
///
/// Unknown dim k + c of an element belongs to its shape function k, direction c. SIMD lanes from
/// `count` on repeat the last element; their results are not used.
struct Batch {
  int first = 0, count = kLanes;  ///< Elements [first, first + count).
  int n_shapes = 0, dim = 0;      ///< Number of shape functions, and number of directions in space.

  /// Unknowns, rates and accelerations (n_shapes dim each).
  const Pack *q = nullptr, *v = nullptr, *a = nullptr;

  /// Returns the number of unknowns of one element.
  int n_local() const { return n_shapes * dim; }
};

/// Size of the vector registers that a pack type uses [bytes].
template <class V>
inline constexpr int kBytesOf = 16;
/// Size of the vector registers of PackOf<kWidth> [bytes].
template <int kWidth>
inline constexpr int kBytesOf<PackOf<kWidth>> = kWidth* static_cast<int>(sizeof(double));

}  // namespace flexmorph::fem
