#pragma once

#include "fem/model/workspace.h"
#include "fem/solve/linear_solver.h"

namespace flexmorph::fem {

/// Returns the frequency ω = c / L at which balance_forces() separates slow from fast motion
/// [rad/s]. A pressure wave of speed c = sqrt(E / density) passes the length L of the mesh of the
/// body in the time 1 / ω. Bending along the whole body is slower, and every vibration that a
/// change of the mesh excites inside elements is faster.
/// @param body  Body with material lines at their present positions.
double separating_frequency(const Body& body);

/// Restores the balance of forces of a state whose mesh has changed, at constant time: solves
///
///   M (q̈ + ω² δ) + F(q + δ, q̇) + Φ_qᵀ λ = 0,   Φ(q + δ, t) = 0
///
/// for the displacement δ and the multipliers λ, by Newton's method. Motion that is faster than ω
/// comes to equilibrium under the present inertia forces and does not ring. Slower motion keeps its
/// position and is accelerated by the change of its forces. Therefore the strain energy jumps only
/// by the difference in stiffness between the two meshes, and forces of joints continue smoothly.
///
/// The function changes q, q̈ and λ of the state, but not q̇.
///
/// @param frequency  Frequency ω, see separating_frequency() [rad/s].
/// @param solver     Solver that analyses the pattern and keeps the last factorization.
/// @param matrix     Becomes the matrix that the solver has factored.
/// @returns ω² δ, the change of the accelerations (n_dofs).
/// @throws Error (numerical) naming the time if Newton's method does not converge.
///
/// Source: fem/README.md, Insertion and removal.
VectorXd balance_forces(Workspace& model, State& x, double frequency, DirectSolver& solver,
                        SparseMatrix& matrix);

/// Calls balance_forces() with a solver of its own.
VectorXd balance_forces(Workspace& model, State& x, double frequency);

}  // namespace flexmorph::fem
