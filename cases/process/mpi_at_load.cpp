#include "cases/process/mpi_at_load.h"

#include <dlfcn.h>

namespace {

/// True until the constructors of this object file have run. The constructors of a library run
/// before those of the program that is linked to it, and its destructors run after those of the
/// program.
bool loading = true;
bool unloading = false;

struct Phases {
  Phases() { loading = false; }
  Phases(const Phases&) = delete;
  Phases& operator=(const Phases&) = delete;
  ~Phases() { unloading = true; }
} phases;

/// Returns the flag that a function of MPI's profiling interface (MPI 4.1, section 15.2) gives;
/// false if no MPI is loaded.
bool answer_of_mpi(const char* name) {
  auto* ask = reinterpret_cast<int (*)(int*)>(dlsym(RTLD_DEFAULT, name));
  int yes = 0;
  if (ask != nullptr) ask(&yes);
  return yes != 0;
}

}  // namespace

// While Ipopt 3.14 with MUMPS for MPI is loaded, it calls MPI_Init unless MPI_Initialized gives
// true; while it is unloaded, it calls MPI_Finalize unless MPI_Finalized gives true. At all other
// times both functions give the flags of MPI.
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
