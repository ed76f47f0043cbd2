#include "geometry/vector_level.h"

#include <cstdlib>
#include <string_view>

namespace flexmorph {
namespace {

VectorLevel found() {
#ifdef FLEXMORPH_HAS_VECTOR_LEVELS
  const char* said = std::getenv("FLEXMORPH_VECTORS");
  const std::string_view most = said ? said : "";
  if (most == "baseline") return VectorLevel::baseline;
  __builtin_cpu_init();
  const bool v3 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                  __builtin_cpu_supports("bmi2");
  const bool v4 = v3 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
                  __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
                  __builtin_cpu_supports("avx512cd");
  if (v4 && most != "v3") return VectorLevel::v4;
  if (v3) return VectorLevel::v3;
#endif
  return VectorLevel::baseline;
}

const VectorLevel kLevel = found();

}  // namespace

VectorLevel vector_level() { return kLevel; }

}  // namespace flexmorph
