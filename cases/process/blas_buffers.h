#pragma once

namespace flexmorph {

/// Address space that OpenBLAS maps for every concurrent thread at its first call and does not
/// release: BUFFER_SIZE of its x86_64 builds [bytes]; it is smaller on other processors. Memory is
/// used only where the program writes to it.
inline constexpr double kBlasBuffer = 134'217'728;

/// Maps the buffers of OpenBLAS (kBlasBuffer) and starts the threads of OpenMP now. If OpenBLAS
/// 0.3.21 fails to map a buffer, it tries again in an endless loop (driver/others/memory.c) that
/// only SIGKILL ends; therefore a limit of the address space (ulimit -v) must be detected before.
/// The OpenMP library ends the process if it cannot start a thread.
/// @param threads  number of threads that will compute at the same time
/// @throws Error (input) with the sizes when the address space does not suffice.
void reserve_blas(int threads);

}  // namespace flexmorph
