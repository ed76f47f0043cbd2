#pragma once

#include "fem/dynamics/gradients/transposed_system.h"
#include "fem/dynamics/starts/start.h"

namespace flexmorph::fem {

/// Sees an equilibrium that the start hangs on, with -ψ: adds ψ · ∂F/∂p.
using SeeWork = std::function<void(const State& x, const VectorXd& psi)>;

/// Derivatives of start_state() at the same arguments: what a number that depends on its positions
/// and velocities owes to the forces in its equilibria.
/// @param by_q, by_v  derivatives by x.q and x.v (n_dofs)
/// @throws Error (numerical) as start_state(), or where an equilibrium is singular.
void derive_start(Workspace& model, std::span<const Growth> growths, double t, Start kind,
                  const Placement& placement, double delta, const VectorXd& by_q,
                  const VectorXd& by_v, const SeeWork& see);

}  // namespace flexmorph::fem
