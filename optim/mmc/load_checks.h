#pragma once

#include "optim/mmc/compliance.h"

namespace flexmorph::mmc {

/// Are these load sets ones that a Compliance can be made of?
/// @param stiffness0, mass0  factors of the design of the motion; not asked for by 'inertia' loads
/// @throws Error (input) naming the load and what is wrong about it.
void check_loads(const fem::EslSets& loads, const ComplianceSettings& settings,
                 const VectorXd& stiffness0, const VectorXd& mass0);

}  // namespace flexmorph::mmc
