#pragma once

namespace flexmorph::optim {

/// Starts MPI for Ipopt if Ipopt solves its linear systems with a MUMPS that was built for MPI
/// (Debian 13) and MPI has not been started yet. All later calls do nothing.
/// @throws Error (numerical) if MPI does not start.
void start_mpi_for_ipopt();

}  // namespace flexmorph::optim
