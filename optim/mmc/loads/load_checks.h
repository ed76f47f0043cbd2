#pragma once

#include "optim/mmc/loads/compliance_evaluator.h"

namespace flexmorph::mmc {

/// Checks that a ComplianceEvaluator can be created from the equivalent static loads of a motion.
/// @param stiffness0, mass0  scale factors of the design that the motion was computed with; not
///        used by `inertia` loads
/// @throws Error (input) naming the load and its error.
void check_loads(const fem::EslSets& loads, const ComplianceSettings& settings,
                 const VectorXd& stiffness0, const VectorXd& mass0);

/// Refuses a load case of a static plate with a message.
/// @throws Error (input) always.
[[noreturn]] void refuse(const LoadCase& load, const std::string& what);
/// Checks the numbers of a load case of a static plate.
/// @throws Error (input) naming the load case and its error.
void check_load(const LoadCase& load, const Grid& grid);

}  // namespace flexmorph::mmc
