#include "geometry/vector_level.h"

#include <algorithm>

#include "geometry/vector_limit.h"

namespace flexmorph {
namespace {

VectorLevel level_of_processor() {
#ifdef FLEXMORPH_HAS_VECTOR_LEVELS
  __builtin_cpu_init();
  const bool v3 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                  __builtin_cpu_supports("bmi2");
  const bool v4 = v3 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
                  __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
                  __builtin_cpu_supports("avx512cd");
  if (v4) return VectorLevel::v4;
  if (v3) return VectorLevel::v3;
#endif
  return VectorLevel::baseline;
}

VectorLevel level = level_of_processor();

}  // namespace

VectorLevel vector_level() { return level; }

void limit_vector_level(VectorLevel most) { level = std::min(level_of_processor(), most); }

}  // namespace flexmorph
