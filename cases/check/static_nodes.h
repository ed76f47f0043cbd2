#pragma once

#include <string>

#include "cases/scene/scene.h"
#include "optim/mmc/problem/body_problem.h"

namespace flexmorph::cases {

/// Returns the lines of a summary about the nodes of every support and every force of a static
/// scene: their number and their extent.
std::string static_nodes_text(const Scene& scene, const mmc::BodyProblem& problem);

/// Returns the line of a summary about the size of the drawing of a static plate; empty if its
/// shape is not drawn.
std::string drawing_text(const Domain& domain);

}  // namespace flexmorph::cases
