#pragma once

#include <string>
#include <vector>

#include "cases/scene/scene.h"
#include "optim/mmc/problem/body_problem.h"

namespace flexmorph::cases {

/// Returns messages on missing material of a part. They name solid regions of the case of which
/// more than 1 % is missing; lines and regions of supports and loads that no material reaches; and
/// points of joints, masses and forces without material. The list is empty if nothing is missing,
/// and for a problem without a part.
std::vector<std::string> missing_material(const Scene& scene, const mmc::BodyProblem& problem);

/// Returns messages on the verification of parts if it has no motion on cells, because the plate is
/// static, has heat, moves in space, or has another [verify]. The list is empty if the parts move
/// on cells, and if there are no parts.
std::vector<std::string> motion_notes(const Scene& scene);

}  // namespace flexmorph::cases
