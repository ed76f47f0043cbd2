#pragma once

namespace flexmorph {

/// Address space that OpenBLAS maps for every thread that is in it at the same time, at its first
/// call, and keeps: BUFFER_SIZE of its x86_64 builds [bytes]; other processors take less. Memory is
/// used only where it is written to.
inline constexpr double kBlasBuffer = 134'217'728;

/// Maps these buffers now. OpenBLAS 0.3.21 that cannot have one asks for it again without end
/// (driver/others/memory.c), which nobody but SIGKILL stops; a process whose address space is
/// limited (ulimit -v) must know before. Threads of OpenMP begin here, too: that library ends the
/// process where it cannot have one.
/// @param threads  that will compute at the same time
/// @throws Error (input) when there is no room for them, with the numbers.
void reserve_blas(int threads);

}  // namespace flexmorph
