#pragma once

#include <cstdio>
#include <fstream>
#include <string>

#include "cases/process/processor.h"
#include "fem/solve/linear_solver.h"
#include "geometry/cpu_time.h"

namespace flexmorph::benchmark {

/// Must be called first in main(): selects one thread and the BLAS kernels of all programs, and
/// prints the processor for the tables.
inline void begin(char** argv) {
  set_up_processor(1, argv);
  std::string model = "unknown processor";
  std::ifstream cpuinfo("/proc/cpuinfo");
  for (std::string line; std::getline(cpuinfo, line);)
    if (line.starts_with("model name")) model = line.substr(line.find(':') + 2);
  std::printf("%s, OpenBLAS kernels %s, one thread\n", model.c_str(), fem::blas_kernel().c_str());
}

}  // namespace flexmorph::benchmark
