#pragma once

#include "fem/model/workspace.h"

namespace flexmorph::fem {

/// Force and moment of generalized forces on one body.
/// @param force  on the unknowns of the model (n_dofs)
/// @param about  the point that the moment is about, in the world [m]
Wrench wrench_on(const Body& body, const VectorXd& force, const Vec3& about, const State& x);

}  // namespace flexmorph::fem
