#pragma once

#include "fem/model/workspace.h"

namespace flexmorph::fem {

/// Result of assemble(): the number of iterations and the size of the corrections.
struct Assembly {
  int iterations = 0;  ///< Number of Newton iterations for the positions.
  double miss = 0;     ///< Largest entry of the remaining violation |R Φ| [m] (ScaledConstraints).
  double displacement = 0;     ///< Largest change of an unknown, as a displacement [m].
  double velocity_change = 0;  ///< Largest change of a rate of an unknown, as a velocity [m/s].
};

/// Assembles a model: corrects the unknowns to Φ(q, x.t) = 0, then the rates to Φ_q v + Φ_t = 0.
///
/// The positions are found by damped Newton steps, each the smallest correction in the mass norm,
///
///   [ M   Φ_qᵀ ] [ Δq ]   [  0 ]
///   [ Φ_q  -δ  ] [ μ  ] = [ -Φ ],
///
/// with a line search on |R Φ|². δ starts at 1e-9 of a typical compliance. It is raised where a
/// step had to be shortened (Levenberg-Marquardt in the mass norm) and lowered, down to 1e-14,
/// after full steps. Therefore redundant rows are harmless, and contradictory or unreachable
/// constraints end at a best fit. The velocities are found by the smallest change of v in the mass
/// norm.
///
/// M may be singular (free material lines, bodies without inertia). Therefore every diagonal entry
/// gets 1e-8 of the mean of its body in displacement units (of the mean of the model where the body
/// has no mass, and 1 where no body has mass).
///
/// A joint that pulls at one point of an elastic body is followed by a local peak of strain,
/// because this norm contains no stiffness. Therefore the caller should place plates near their
/// position first, so that only small violations are left to this function.
///
/// Some constraints have false roots (an axis turned by 180 degrees). Only a start near the right
/// root avoids them.
///
/// @param x  in: t, q and v near the assembled model; out: its q and v.
/// @throws Error (numerical) naming the joint with the largest violation, its amount and the number
///     of iterations, when no assembled position is found, or no velocity that all joints allow.
Assembly assemble(Workspace& model, State& x);

}  // namespace flexmorph::fem
