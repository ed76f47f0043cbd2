#pragma once

namespace flexmorph::optim {

/// Starts MPI for Ipopt, if this Ipopt solves its linear systems with a MUMPS that was built for
/// MPI (Debian 13) and nobody has started MPI. Every later call does nothing.
///
/// Such an Ipopt starts MPI as soon as the library is loaded: half a second, a thread, files in
/// /tmp and in /dev/shm for every command, although few commands use Ipopt. Therefore the two
/// questions that Ipopt asks while libraries are loaded and unloaded are answered in
/// mpi_when_needed.cpp.
/// @throws Error (numerical) if MPI does not start.
void start_mpi_for_ipopt();

}  // namespace flexmorph::optim
