#pragma once

namespace flexmorph {

/// Links MPI_Initialized() and MPI_Finalized() of mpi_at_load.cpp into the program, so that Ipopt
/// does not start and end MPI while libraries are loaded and unloaded. The call itself does
/// nothing.
///
/// An Ipopt that solves its linear systems with a MUMPS for MPI (Debian 13) starts MPI when the
/// library is loaded. This costs half a second, a thread, and files in /tmp and in /dev/shm for
/// every command, although few commands use Ipopt. optim::start_mpi_for_ipopt() starts MPI when it
/// is needed.
void keep_mpi_off_at_load();

}  // namespace flexmorph
