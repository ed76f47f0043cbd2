#pragma once

namespace flexmorph {

/// Sets the number of threads and the kernels of the process, for every program of the repository,
/// tests and benchmarks included: `threads` threads for the loops of Flexmorph over loads and
/// cells, one thread for OpenBLAS (more only slow down the small blocks of a factorization), and
/// the kernels kernel_for_processor() of OpenBLAS.
///
/// FLEXMORPH_VECTORS=baseline or v3 in the environment excludes wider vectors from the kernels of
/// Flexmorph (geometry/vector_level.h); v4 is the default.
///
/// Open MPI, if Ipopt loads it, neither searches a network nor shares memory.
///
/// OpenMP and OpenBLAS read their environment variables when they are loaded; therefore the process
/// executes itself a second time with these variables set (set_environment()), unless it was
/// started with them. The function must be called at the beginning of main(), before any action
/// that must not be repeated.
/// @param argv  arguments of main()
/// @throws Error (input) if FLEXMORPH_VECTORS has another value
void set_up_processor(int threads, char** argv);

}  // namespace flexmorph
