#include "cases/process/mpi_at_load.h"

#include <dlfcn.h>

namespace {

/// True until the constructors of this object file have run. Libraries are constructed before the
/// program that links to them, and destroyed after it.
bool loading = true;
bool unloading = false;

struct Phases {
  Phases() { loading = false; }
  Phases(const Phases&) = delete;
  Phases& operator=(const Phases&) = delete;
  ~Phases() { unloading = true; }
} phases;

/// The answer of MPI's profiling interface (MPI 4.1, section 15.2); no where no MPI is loaded.
bool answer_of_mpi(const char* name) {
  auto* ask = reinterpret_cast<int (*)(int*)>(dlsym(RTLD_DEFAULT, name));
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

namespace flexmorph {

void keep_mpi_off_at_load() {}

}  // namespace flexmorph
