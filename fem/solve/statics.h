#pragma once

#include "fem/model.h"

namespace flexmorph::fem {

/// Equilibrium of a model in a steadily rotating frame by Newton's method with exact tangent:
///
///   F(q) - M ω² (q - center) + Φ_qᵀ λ = 0,   Φ(q, x.t) = 0
///
/// @param spin    ω² of every unknown (n_dofs) [1/s²]: zero gives plain statics
/// @param center  what the centrifugal acceleration is taken from (n_dofs) [m]
/// @param x       in: start of the iteration; out: q and λ of the equilibrium
/// @throws Error (numerical) when Newton does not converge in 40 iterations.
void solve_rotating_equilibrium(Model& model, const VectorXd& spin, const VectorXd& center,
                                State& x);

}  // namespace flexmorph::fem
