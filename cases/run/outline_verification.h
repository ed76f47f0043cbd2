#pragma once

#include <functional>

#include "cases/output/run_folder.h"
#include "cases/results/verified_outline.h"

namespace flexmorph::cases {

/// Verifies the outline of a final design and writes its meshes, where there is a folder. A
/// verification that fails says why; the run continues.
/// @param loads  of the motion; null: the loads of a plate at rest
/// @param go_on  asked on the way: false ends with the result of coarser meshes
VerifiedOutline verify_outline_of(const Scene& scene, const mmc::BodyProblem& problem,
                                  const fem::EslSets* loads, const std::function<bool()>& go_on,
                                  RunFolder* folder);

}  // namespace flexmorph::cases
