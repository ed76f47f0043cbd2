#pragma once

#include "cases/scene/scene.h"
#include "optim/mmc/judged_design.h"

namespace flexmorph::cases {

/// Supports and loads of a plate at rest by position, as the case says them.
judge::Loads judged_loads(const Scene& scene, const mmc::BodyProblem& problem);

}  // namespace flexmorph::cases
