#pragma once

#include <string>

#include "optim/mmc/problem/body_problem.h"
#include "optim/verification/verification.h"

namespace flexmorph::mmc {

/// Returns half the side of the square that stands for a point of a body in its verification: the
/// larger side of a cell [m].
double point_reach(const BodyProblem& problem);

/// Returns the reason why the loads of a motion cannot be applied to the outline of a design; empty
/// if they can. Loads of the definitions `frozen` and `stiffness` cannot, because they are forces
/// at the corners of cells.
std::string reason_not_verifiable(const BodyProblem& problem);

/// Returns equivalent static loads by position: the root line is the clamp of each load, the
/// acceleration field acts on all material in front of it, and concentrated forces act on points.
/// A link (a body between two pins) has no clamp; its loads are balanced, see
/// verification::Balance.
/// @param loads  must outlive the result
verification::Loads loads_by_position(const BodyProblem& problem, const fem::EslSets& loads);

/// Returns the outline of a design as it is exported, see part_of().
std::vector<Region> exported_regions(const BodyProblem& problem);

/// Verifies the design of a problem under its loads by finite elements on the exported outline. The
/// first triangles have a size of two cells.
/// @param regions       outline from exported_regions()
/// @param loads         loads from loads_by_position()
/// @param keep_running  cancellation callback, called after each mesh; false stops
verification::OutlineVerification verify_design(const BodyProblem& problem,
                                                std::span<const Region> regions,
                                                const verification::Loads& loads,
                                                const std::function<bool()>& keep_running = {});

}  // namespace flexmorph::mmc
