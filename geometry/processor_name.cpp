#include "geometry/processor_name.h"

#include <sys/utsname.h>

#include <fstream>

#include "geometry/vector_level.h"

namespace flexmorph {

std::string processor_name() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (const size_t colon = line.find(": ");
        line.starts_with("model name") && colon != std::string::npos)
      return line.substr(colon + 2);
  utsname system{};
  return uname(&system) == 0 ? system.machine : "unknown";
}

std::string vector_level_name() {
  const VectorLevel level = vector_level();
  if (level == VectorLevel::v4) return "v4";
  return level == VectorLevel::v3 ? "v3" : "baseline";
}

}  // namespace flexmorph
