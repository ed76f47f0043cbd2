#pragma once

#include <cstddef>

namespace flexmorph::fem {

inline constexpr int kLanes = 8;

/// One number of each of eight elements: arithmetic works on all of them at once. (The vector
/// extension of GCC and Clang: on processors with narrower registers it becomes several
/// instructions, with the same result.)
using Lanes = double __attribute__((vector_size(kLanes * sizeof(double))));

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

}  // namespace flexmorph::fem
