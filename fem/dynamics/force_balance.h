#pragma once

#include "fem/model/workspace.h"

namespace flexmorph::fem {

/// The frequency that balance_forces() separates at, ω = c / L: a wave of pressure, of speed
/// c = sqrt(E / density), passes the length L of the mesh of a body in the time 1 / ω. Bending
/// along the whole body is slower, and all that a change of the mesh sets off inside elements is
/// faster [rad/s].
/// @param body  with material lines, where they are now
double separating_frequency(const Body& body);

/// Puts a state whose mesh has changed into balance, without time passing: solves
///
///   M (q̈ + ω² δ) + F(q + δ, q̇) + Φ_qᵀ λ = 0,   Φ(q + δ, t) = 0
///
/// for the displacement δ and the multipliers λ, by Newton's method. What is faster than ω comes to
/// equilibrium under the inertia forces that act, and does not ring; what is slower stays where it
/// is, and the change of its forces accelerates it. So strain energy jumps by what one mesh is
/// stiffer than the other and no more, and forces of joints go on smoothly.
///
/// q, q̈ and λ of the state change; q̇ does not.
///
/// @param frequency  ω, see separating_frequency() [rad/s]
/// @returns ω² δ, the change of the accelerations (n_dofs).
/// @throws Error (numerical) naming the time where Newton's method does not converge.
///
/// Source: fem/README.md, Insertion and removal.
VectorXd balance_forces(Workspace& model, State& x, double frequency);

}  // namespace flexmorph::fem
