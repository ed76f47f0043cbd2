#pragma once

#include "optim/mmc/loads/compliance_evaluator.h"

namespace flexmorph::mmc {

/// Checks that a ComplianceEvaluator can be made of load sets of a motion.
/// @param stiffness0, mass0  factors of the design of the motion; not asked for by 'inertia' loads
/// @throws Error (input) naming the load and what is wrong about it.
void check_loads(const fem::EslSets& loads, const ComplianceSettings& settings,
                 const VectorXd& stiffness0, const VectorXd& mass0);

/// Refuses a load of a plate at rest. @throws Error (input) always.
[[noreturn]] void refuse(const LoadCase& load, const std::string& what);
/// Checks the numbers of a load of a plate at rest.
/// @throws Error (input) naming the load and what is wrong about it.
void check_load(const LoadCase& load, const Grid& grid);

}  // namespace flexmorph::mmc
