#pragma once

#include "fem/model/workspace.h"

namespace flexmorph::fem {

/// Returns the resultant force and moment of generalized forces on one body.
/// @param force  generalized forces on the unknowns of the model (n_dofs)
/// @param about  reference point of the moment, in the world [m]
Wrench wrench_on(const Body& body, const VectorXd& force, const Vec3& about, const State& x);

}  // namespace flexmorph::fem
