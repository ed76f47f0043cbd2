#pragma once

#include "optim/mmc/cycles/body_design.h"

namespace flexmorph::mmc {

/// Part of a limit that a crisp design may be beyond it.
inline constexpr double kLimitTolerance = 5e-3;

/// The value of a response of the goal, of a crisp design, in the unit of the row.
double crisp_value(const ResponseRow& row, const Goal& goal, const SharpDesign& crisp);

/// Tells whether a limit binds this body alone: what bodies share is no limit of one of them.
bool binds_body(const Limit& limit, const BodyProblem& problem);

/// Part by which the crisp design is beyond the limit that it violates most; 0 where it keeps to
/// all of them within kLimitTolerance, infinite where no material joins a load to a support.
double crisp_violation(const BodyProblem& problem, const SharpDesign& crisp);

/// Tells whether a body that is optimized for its compliance is more compliant, crisp, than uniform
/// material of the same volume under the same loads: such a design is of no use.
bool worse_than_uniform(const BodyProblem& problem, const BodyOutcome& outcome);

}  // namespace flexmorph::mmc
