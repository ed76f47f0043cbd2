#pragma once

#include <string>

namespace flexmorph {

/// Returns the kernels of OpenBLAS for this processor unless OPENBLAS_CORETYPE gives others:
/// "SkylakeX" (AVX-512), "Haswell" (AVX2 with FMA), or an empty text, which leaves the choice to
/// the library. The choice of the library is avoided where possible: version 0.3.21 does not
/// support newer processors and selects kernels of the year 2004 for them, and its results differ
/// in the last bits between processors that could use equal kernels.
std::string kernel_for_processor();

/// Sets the environment variables that OpenMP, OpenBLAS and Open MPI read when they are loaded, see
/// set_up_processor(). They apply to programs that this process starts. OPENBLAS_CORETYPE,
/// OMP_WAIT_POLICY and OMPI_MCA_* are not changed if they are set already.
/// @param threads  number of threads for the loops of Flexmorph
/// @returns false if the process was started with the variables for this number of threads
bool set_environment(int threads);

}  // namespace flexmorph
