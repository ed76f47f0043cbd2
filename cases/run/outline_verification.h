#pragma once

#include <functional>

#include "cases/output/run_folder.h"
#include "cases/results/parts/verified_outline.h"

namespace flexmorph::cases {

/// Verifies the outline of a final design by finite elements and writes its meshes if there is a
/// folder. If the verification fails, the result contains the reason, and the run continues.
/// @param loads   loads of the motion; null means the loads of a static plate
/// @param keep_running   cancellation callback; after false the result is that of the coarser
/// meshes
/// @param folder  receives the meshes; null means that nothing is written
VerifiedOutline verify_outline_of(const Scene& scene, const mmc::BodyProblem& problem,
                                  const fem::EslSets* loads,
                                  const std::function<bool()>& keep_running, RunFolder* folder);

}  // namespace flexmorph::cases
