#pragma once

#include <cstdio>
#include <string>

#include "cases/process/processor.h"
#include "fem/solve/linear_solver.h"
#include "geometry/cpu_time.h"
#include "geometry/processor_name.h"

namespace flexmorph::benchmark {

/// Must be called first in main(): selects one thread and the BLAS kernels of all programs, and
/// prints the processor for the tables.
inline void begin(char** argv) {
  set_up_processor(1, argv);
  std::printf("%s, OpenBLAS kernels %s, one thread\n", processor_name().c_str(),
              fem::blas_kernel().c_str());
}

}  // namespace flexmorph::benchmark
