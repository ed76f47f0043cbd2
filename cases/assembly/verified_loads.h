#pragma once

#include "cases/scene/scene.h"
#include "optim/mmc/cycles/design_verification.h"

namespace flexmorph::cases {

/// Supports and loads of a plate at rest by position, as the case says them.
verification::Loads loads_by_position(const Scene& scene, const mmc::BodyProblem& problem);

}  // namespace flexmorph::cases
