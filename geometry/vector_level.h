#pragma once

/// Kernels for the vector registers of the processor at hand, in libraries that run on every
/// x86-64.
namespace flexmorph {

/// Registers that kernels are compiled for: of every processor of the family, AVX2 with fused
/// multiply-add (x86-64-v3), and AVX-512 (x86-64-v4).
enum class VectorLevel { baseline, v3, v4 };

/// Returns the level that kernels use: that of the processor, unless limit_vector_level()
/// (geometry/vector_limit.h) was called.
VectorLevel vector_level();

namespace vector_levels {
template <class Part>
[[gnu::noinline]] void part_of_all(const Part& part) {
  part();
}
}  // namespace vector_levels

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define FLEXMORPH_HAS_VECTOR_LEVELS 1
namespace vector_levels {
template <class Kernel>
[[gnu::target("arch=x86-64-v3"), gnu::flatten]] inline void run_v3(const Kernel& kernel) {
  kernel.template operator()<32>();
}
template <class Kernel>
[[gnu::target("arch=x86-64-v4"), gnu::flatten]] inline void run_v4(const Kernel& kernel) {
  kernel.template operator()<64>();
}
template <class Part>
[[gnu::target("arch=x86-64-v3"), gnu::flatten, gnu::noinline]] void part_v3(const Part& part) {
  part();
}
template <class Part>
[[gnu::target("arch=x86-64-v4"), gnu::flatten, gnu::noinline]] void part_v4(const Part& part) {
  part();
}
}  // namespace vector_levels
#endif

/// Runs a kernel, a function object that is told how many bytes a register has:
/// `kernel.template operator()<16>()`, 32 or 64. All that it calls is compiled into it, for each of
/// the levels; functions that are not inline stay what they are.
template <class Kernel>
inline void run_kernel(const Kernel& kernel) {
#ifdef FLEXMORPH_HAS_VECTOR_LEVELS
  const VectorLevel level = vector_level();
  if (level == VectorLevel::v4) return vector_levels::run_v4(kernel);
  if (level == VectorLevel::v3) return vector_levels::run_v3(kernel);
#endif
  kernel.template operator()<16>();
}

/// Runs a part of a kernel, a function object without arguments, for registers of so many bytes. It
/// is compiled once for all kernels that call it, because it is large.
template <int kBytes, class Part>
inline void run_kernel_part(const Part& part) {
#ifdef FLEXMORPH_HAS_VECTOR_LEVELS
  if constexpr (kBytes == 64) return vector_levels::part_v4(part);
  if constexpr (kBytes == 32) return vector_levels::part_v3(part);
#endif
  vector_levels::part_of_all(part);
}

}  // namespace flexmorph
