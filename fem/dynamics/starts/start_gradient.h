#pragma once

#include "fem/dynamics/gradients/transposed_system.h"
#include "fem/dynamics/starts/start.h"

namespace flexmorph::fem {

/// A function that receives an equilibrium x on which the start depends, with a vector ψ (n_dofs),
/// and adds ψ · ∂F/∂p to a gradient.
using SeeWork = std::function<void(const State& x, const VectorXd& psi)>;

/// Computes the derivative of a scalar through start_state(), called with equal arguments: its
/// dependence on the forces in the equilibria of the start.
/// @param by_q, by_v  Derivatives of the scalar with respect to x.q and x.v of the start (n_dofs).
/// @param see         Called for every equilibrium with the negative adjoint solution.
/// @throws Error (numerical) as start_state(), or if an equilibrium is singular.
void derive_start(Workspace& model, std::span<const MovingRoot> moving_roots, double t, Start kind,
                  const BodyPoses& body_poses, double delta, const VectorXd& by_q,
                  const VectorXd& by_v, const SeeWork& see);

}  // namespace flexmorph::fem
