#include "optim/mpi_when_needed.h"

#include <dlfcn.h>

#include <string>

#include "geometry/base.h"

namespace {

/// True until the constructors of this object file have run. Libraries are constructed before the
/// program or the library that links to them, and destroyed after it.
bool loading = true;
bool unloading = false;

struct Phases {
  Phases() { loading = false; }
  Phases(const Phases&) = delete;
  Phases& operator=(const Phases&) = delete;
  ~Phases() { unloading = true; }
} phases;

/// The function of MPI's profiling interface, null where no MPI is loaded: MPI 4.1, section 15.2.
template <typename Function>
Function* function_of_mpi(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_DEFAULT, name));
}

using Question = int(int*);

bool answer_of_mpi(const char* name) {
  auto* ask = function_of_mpi<Question>(name);
  int yes = 0;
  if (ask != nullptr) ask(&yes);
  return yes != 0;
}

}  // namespace

// Ipopt 3.14 with MUMPS for MPI calls MPI_Init while it is loaded unless MPI_Initialized says yes,
// and MPI_Finalize while it is unloaded unless MPI_Finalized says yes. At every other time the two
// answers are those of MPI.
extern "C" {

__attribute__((visibility("default"))) int MPI_Initialized(int* flag) {
  *flag = loading || answer_of_mpi("PMPI_Initialized") ? 1 : 0;
  return 0;
}

__attribute__((visibility("default"))) int MPI_Finalized(int* flag) {
  const bool never_started = unloading && !answer_of_mpi("PMPI_Initialized");
  *flag = never_started || answer_of_mpi("PMPI_Finalized") ? 1 : 0;
  return 0;
}

}  // extern "C"

namespace flexmorph::optim {

void start_mpi_for_ipopt() {
  auto* start = function_of_mpi<int(int*, char***)>("PMPI_Init");
  if (start == nullptr || answer_of_mpi("PMPI_Initialized") || answer_of_mpi("PMPI_Finalized"))
    return;
  if (const int code = start(nullptr, nullptr); code != 0)
    throw Error::numerical(
        "ipopt: MPI, which its linear solver needs, does not start: MPI_Init "
        "returned " +
        std::to_string(code));
}

}  // namespace flexmorph::optim
