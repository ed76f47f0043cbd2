#pragma once

#include <string>
#include <vector>

#include "cases/scene/scene.h"
#include "optim/mmc/problem/body_problem.h"

namespace flexmorph::cases {

/// Sentences on the material that a part lacks where its body is held, carries something or is
/// solid in the case: solid regions of which more than 1 % is missing, lines and places of supports
/// and loads, and points of joints, masses and forces without any. Empty where nothing is missing,
/// and for a problem without a part.
std::vector<std::string> missing_material(const Scene& scene, const mmc::BodyProblem& problem);

/// Sentences on the motion that verifies parts where it is not one of their cells: a plate at rest,
/// heat, space, or another [verify]. Empty where parts move on cells, and without parts.
std::vector<std::string> motion_notes(const Scene& scene);

}  // namespace flexmorph::cases
