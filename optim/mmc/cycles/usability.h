#pragma once

#include "optim/mmc/cycles/body_design.h"

namespace flexmorph::mmc {

/// Relative amount by which a crisp design may exceed a limit.
inline constexpr double kLimitTolerance = 5e-3;

/// Returns the value of a response of the goal for a crisp design, in the unit of the row.
double crisp_value(const ResponseRow& row, const Goal& goal, const CrispDesign& crisp);

/// Tells whether a limit applies to this body alone; a limit on the mass that bodies have in common
/// does not.
bool binds_body(const Limit& limit, const BodyProblem& problem);

/// Returns the largest relative amount by which the crisp design exceeds a limit. It is 0 if the
/// design meets all limits within kLimitTolerance, and infinite if no material connects a load to a
/// support.
double crisp_violation(const BodyProblem& problem, const CrispDesign& crisp);

/// Tells whether the crisp design of a body with the compliance as objective is more compliant than
/// uniform material of the same volume under the same loads. Such a design is useless.
bool worse_than_uniform(const BodyProblem& problem, const BodyOutcome& outcome);

}  // namespace flexmorph::mmc
