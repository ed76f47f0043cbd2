#pragma once

#include <ctime>

namespace flexmorph::benchmark {

/// CPU time of the process [s].
inline double cpu() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace flexmorph::benchmark
