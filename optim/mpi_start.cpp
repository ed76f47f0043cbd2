#include "optim/mpi_start.h"

#include <dlfcn.h>

#include <string>

#include "geometry/base.h"

namespace flexmorph::optim {
namespace {

/// Returns a function of MPI's profiling interface (MPI 4.1, section 15.2), null if no MPI library
/// is loaded.
template <typename Function>
Function* function_of_mpi(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_DEFAULT, name));
}

bool answer_of_mpi(const char* name) {
  auto* ask = function_of_mpi<int(int*)>(name);
  int yes = 0;
  if (ask != nullptr) ask(&yes);
  return yes != 0;
}

}  // namespace

void start_mpi_for_ipopt() {
  auto* start = function_of_mpi<int(int*, char***)>("PMPI_Init");
  if (start == nullptr || answer_of_mpi("PMPI_Initialized") || answer_of_mpi("PMPI_Finalized"))
    return;
  if (const int code = start(nullptr, nullptr); code != 0)
    throw Error::numerical(
        "ipopt: MPI, which its linear solver needs, cannot be started: MPI_Init returned " +
        std::to_string(code));
}

}  // namespace flexmorph::optim
