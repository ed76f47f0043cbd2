#pragma once

#include "cases/scene/scene.h"
#include "optim/mmc/cycles/design_verification.h"

namespace flexmorph::cases {

/// Returns the supports and the loads of a static plate by their positions, as given in the case.
verification::Loads loads_by_position(const Scene& scene, const mmc::BodyProblem& problem);

}  // namespace flexmorph::cases
