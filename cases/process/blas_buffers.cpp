#include "cases/process/blas_buffers.h"

#include <omp.h>
#include <sys/mman.h>
#include <sys/resource.h>

#include <cmath>
#include <mutex>
#include <string>
#include <vector>

#include "geometry/base.h"

extern "C" void* blas_memory_alloc(int purpose);  // part of OpenBLAS, declared in no header
extern "C" void blas_memory_free(void* buffer);

namespace flexmorph {
namespace {

constexpr double kStack = 8'388'608;  // default stack size of a thread [bytes]

/// Returns true if the system can map this amount of memory.
bool can_map(double bytes) {
  const auto size = static_cast<size_t>(bytes);
  void* trial = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (trial == MAP_FAILED) return false;
  munmap(trial, size);
  return true;
}

std::string megabytes(double bytes) { return std::to_string(std::lround(bytes / 1e6)) + " MB"; }

std::string limit_text() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
    return "the address space of the process is limited to " +
           megabytes(static_cast<double>(limit.rlim_cur)) + " (ulimit -v)";
  return "the system does not provide this memory";
}

}  // namespace

void reserve_blas(int threads) {
  static std::mutex mutex;  // the buffers belong to the whole process
  static int reserved = 0;
  const std::lock_guard lock(mutex);
  if (threads <= reserved) return;
  const double more = threads - reserved, stacks = threads > 1 ? more * kStack : 0;
  if (!can_map(more * kBlasBuffer + stacks))
    throw Error::input("memory: OpenBLAS needs an address space of " +
                       megabytes(threads * kBlasBuffer) + " for " + std::to_string(threads) +
                       (threads > 1 ? " threads" : " thread") + ", but " + limit_text());
  std::vector<void*> buffers;
  for (int k = 0; k < threads; ++k) buffers.push_back(blas_memory_alloc(0));
  for (void* buffer : buffers) blas_memory_free(buffer);  // the buffers stay mapped
  if (threads > 1) {
#pragma omp parallel num_threads(threads)
    {}
  }
  reserved = threads;
}

}  // namespace flexmorph
