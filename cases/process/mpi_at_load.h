#pragma once

namespace flexmorph {

/// Makes the program answer the two questions that Ipopt asks while libraries are loaded and
/// unloaded: whether MPI was started, and whether it was ended. A call does nothing; it links the
/// answers of mpi_at_load.cpp into the program.
///
/// An Ipopt that solves its linear systems with a MUMPS for MPI (Debian 13) starts MPI as soon as
/// the library is loaded: half a second, a thread, files in /tmp and in /dev/shm for every command,
/// although few commands use Ipopt. optim::start_mpi_for_ipopt() starts it when it is needed.
void keep_mpi_off_at_load();

}  // namespace flexmorph
