#pragma once

#include "cases/output/run_folder.h"
#include "cases/results/verified_outline.h"

namespace flexmorph::cases {

/// Writes the last mesh of a verified outline for other programs: design.inp with its loads, .msh,
/// .geo and, where the scene wants files for ParaView, .vtu with displacement and stress.
/// @param regions  of the outline
/// @throws Error (numerical) when a file cannot be written
void write_outline_meshes(const Scene& scene, const mmc::BodyProblem& problem,
                          std::span<const Region> regions,
                          const verification::OutlineVerification& verification, RunFolder& folder);

}  // namespace flexmorph::cases
