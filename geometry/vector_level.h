#pragma once

/// Numerical kernels that use the SIMD registers of the processor on which the program runs, in
/// libraries that run on every x86-64 processor.
namespace flexmorph {

/// Instruction sets that kernels are compiled for: every x86-64 processor (baseline), AVX2 with
/// fused multiply-add (v3: x86-64-v3), and AVX-512 (v4: x86-64-v4).
enum class VectorLevel { baseline, v3, v4 };

/// Returns the instruction set that kernels use. It is the best one of the processor unless
/// limit_vector_level() (geometry/vector_limit.h) has set a lower one.
VectorLevel vector_level();

namespace vector_levels {
/// Runs a part of a kernel with the baseline instructions.
template <class Part>
[[gnu::noinline]] void part_of_all(const Part& part) {
  part();
}
}  // namespace vector_levels

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define FLEXMORPH_HAS_VECTOR_LEVELS 1
namespace vector_levels {
/// Runs a kernel with the instructions of x86-64-v3 (32-byte registers).
template <class Kernel>
[[gnu::target("arch=x86-64-v3"), gnu::flatten]] inline void run_v3(const Kernel& kernel) {
  kernel.template operator()<32>();
}
/// Runs a kernel with the instructions of x86-64-v4 (64-byte registers).
template <class Kernel>
[[gnu::target("arch=x86-64-v4"), gnu::flatten]] inline void run_v4(const Kernel& kernel) {
  kernel.template operator()<64>();
}
/// Runs a part of a kernel with the instructions of x86-64-v3.
template <class Part>
[[gnu::target("arch=x86-64-v3"), gnu::flatten, gnu::noinline]] void part_v3(const Part& part) {
  part();
}
/// Runs a part of a kernel with the instructions of x86-64-v4.
template <class Part>
[[gnu::target("arch=x86-64-v4"), gnu::flatten, gnu::noinline]] void part_v4(const Part& part) {
  part();
}
}  // namespace vector_levels
#endif

/// Runs a kernel with the instruction set vector_level(). The kernel is a function object with the
/// register size in bytes as a template argument: `kernel.template operator()<16>()`, 32 or 64. All
/// inline functions that it calls are compiled into it, once for each instruction set; other
/// functions are called as they are.
template <class Kernel>
inline void run_kernel(const Kernel& kernel) {
#ifdef FLEXMORPH_HAS_VECTOR_LEVELS
  const VectorLevel level = vector_level();
  if (level == VectorLevel::v4) return vector_levels::run_v4(kernel);
  if (level == VectorLevel::v3) return vector_levels::run_v3(kernel);
#endif
  kernel.template operator()<16>();
}

/// Runs a part of a kernel, a function object without arguments, with the instruction set that has
/// registers of kBytes bytes. The part is compiled once for all kernels that call it, because it is
/// large.
template <int kBytes, class Part>
inline void run_kernel_part(const Part& part) {
#ifdef FLEXMORPH_HAS_VECTOR_LEVELS
  if constexpr (kBytes == 64) return vector_levels::part_v4(part);
  if constexpr (kBytes == 32) return vector_levels::part_v3(part);
#endif
  vector_levels::part_of_all(part);
}

}  // namespace flexmorph
