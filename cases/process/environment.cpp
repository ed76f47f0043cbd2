#include "cases/process/environment.h"

#include <cstdlib>

namespace flexmorph {

std::string kernel_for_processor() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw"))
    return "SkylakeX";
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return "Haswell";
#endif
  return "";
}

bool set_environment(int threads) {
  const char* mark = "FLEXMORPH_THREADS";  // set by the first execution of the process
  const std::string n = std::to_string(threads);
  const char* seen = std::getenv(mark);
  if (seen && n == seen) return false;
  setenv(mark, n.c_str(), 1);
  setenv("OMP_THREAD_LIMIT", n.c_str(), 1);
  setenv("OMP_NUM_THREADS", n.c_str(), 1);
  setenv("OMP_WAIT_POLICY", "passive", 0);  // motions have no work for a second thread
  setenv("OPENBLAS_NUM_THREADS", "1", 1);
  if (const std::string kernel = kernel_for_processor(); !kernel.empty())
    setenv("OPENBLAS_CORETYPE", kernel.c_str(), 0);
  // Settings for Open MPI, if Ipopt loads it: one process needs no network and no shared memory.
  setenv("OMPI_MCA_pml", "ob1", 0);
  setenv("OMPI_MCA_btl", "self", 0);
  setenv("OMPI_MCA_osc", "rdma", 0);
  setenv("OMPI_MCA_coll", "basic,self,libnbc,inter,tuned", 0);
  return true;
}

}  // namespace flexmorph
