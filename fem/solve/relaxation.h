#pragma once

#include "fem/model/workspace.h"

namespace flexmorph::fem {

/// Moves a model at rest to a stable equilibrium near x, against the gradient of its potential
/// energy: every step finds the equilibrium with a force κ M (q - q₀) that pulls back to the last
/// position q₀, where κ is halved after a step and raised where the model moves too far. In
/// contrast to Newton's method, no step ends at a maximum or a saddle of the energy.
/// @param x  in: assembled state, even far from the equilibrium; out: the last position
/// @returns false if the steps did not end, for example because nothing restores a falling body
bool relax_to_equilibrium(Workspace& model, State& x);

}  // namespace flexmorph::fem
