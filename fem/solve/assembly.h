#pragma once

#include "fem/model/workspace.h"

namespace flexmorph::fem {

struct Assembly {
  int iterations = 0;
  double miss = 0;             ///< largest |R Φ| left [m] (ScaledConstraints)
  double displacement = 0;     ///< largest change of an unknown, as a displacement [m]
  double velocity_change = 0;  ///< likewise [m/s]
};

/// Puts a model together: from unknowns near it to Φ(q, x.t) = 0, then Φ_q v + Φ_t = 0.
///
/// Positions by damped Newton steps, each the smallest correction in the mass norm,
///
///   [ M   Φ_qᵀ ] [ Δq ]   [  0 ]
///   [ Φ_q  -δ  ] [ μ  ] = [ -Φ ],
///
/// with a line search on |R Φ|². δ starts at 1e-9 of a typical compliance; it is raised where a
/// step had to be cut short (Levenberg-Marquardt in the mass norm) and lowered, to 1e-14, after
/// whole steps: redundant rows do no harm, contradictory and unreachable ones end at the best fit.
/// Velocities by the smallest change of v in the same norm.
///
/// M may be singular (free material lines, bodies without inertia): every diagonal entry gets 1e-8
/// of the mean of its body in displacement units (of the model, where the body has no mass; 1 where
/// nothing has).
///
/// An elastic body follows a joint that pulls at one point of it with a local spike of strain, for
/// nothing in this norm holds it together: place plates before, and let this close what is left.
///
/// The false roots of some rows (an axis turned by 180 degrees) are avoided by the start alone.
///
/// @param x  in: t, near q, near v; out: q and v of the assembled model.
/// @throws Error (numerical) naming the joint that misses most, by how much, and the iterations,
/// when no assembled position is found, or no velocity that all joints allow.
Assembly assemble(Workspace& model, State& x);

}  // namespace flexmorph::fem
