#pragma once

#include <string>

namespace flexmorph {

/// What a process computes with, decided here for every program of the repository, tests and
/// benchmarks included: `threads` for our own loops over loads and cells, one for OpenBLAS (its own
/// only slow down the small blocks of a factor), and the kernels of OpenBLAS,
/// kernel_for_processor().
///
/// FLEXMORPH_VECTORS=baseline or v3 in the environment leaves wider vectors out of our own kernels
/// (geometry/vector_level.h).
///
/// Open MPI, where Ipopt brings it, neither looks for a network nor shares memory.
///
/// OpenMP and OpenBLAS read their wishes when they are loaded, so the process starts itself once
/// more with them in its environment. What stands there already under OPENBLAS_CORETYPE,
/// OMP_WAIT_POLICY and OMPI_MCA_* is left as it is.
/// @throws Error (input) where FLEXMORPH_VECTORS is something else
/// @param argv  as main() got it; first thing in main(), before anything that must not happen twice
void settle_processor(int threads, char** argv);

/// Kernels of OpenBLAS that this processor gets unless OPENBLAS_CORETYPE says otherwise: "SkylakeX"
/// (AVX-512), "Haswell" (AVX2 with FMA), or none, which leaves the choice to the library. It is not
/// asked where it need not be: version 0.3.21 does not know newer processors, takes kernels of the
/// year 2004 for them, and last bits differ between processors that could have the same.
std::string kernel_for_processor();

}  // namespace flexmorph
