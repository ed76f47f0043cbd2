#pragma once

#include <string>

#include "optim/mmc/problem/body_problem.h"
#include "optim/verification/verification.h"

namespace flexmorph::mmc {

/// How far a point of a body reaches in its verification: one cell to each side [m].
double point_reach(const BodyProblem& problem);

/// Why the loads of a motion cannot be carried over to the outline of a design; empty: they can.
/// Loads of the definitions `frozen` and `stiffness` are forces at the corners of cells.
std::string reason_not_verifiable(const BodyProblem& problem);

/// Equivalent static loads by position: the line of the root as the clamp of each load, the
/// acceleration field on all material in front of it, concentrated forces as points.
/// @param loads  lives longer
verification::Loads loads_by_position(const BodyProblem& problem, const fem::EslSets& loads);

/// The outline as it is exported, see part_of().
std::vector<Region> exported_regions(const BodyProblem& problem);

/// The design of a problem, as it is exported, under its loads. First triangles are two cells
/// large.
verification::OutlineVerification verify_design(const BodyProblem& problem,
                                                std::span<const Region> regions,
                                                const verification::Loads& loads,
                                                const std::function<bool()>& keep_running = {});

}  // namespace flexmorph::mmc
