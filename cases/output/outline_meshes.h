#pragma once

#include "cases/output/run_folder.h"
#include "cases/results/parts/verified_outline.h"

namespace flexmorph::cases {

/// Writes the last mesh of a verified outline for other programs: design.inp with its loads, .msh,
/// .geo and, if the scene has files for ParaView, .vtu with displacement and stress.
/// @param regions       regions that the outline encloses
/// @param verification  mesh and results of the finite-element verification
/// @throws Error (numerical) when a file cannot be written
void write_outline_meshes(const Scene& scene, const mmc::BodyProblem& problem,
                          std::span<const Region> regions,
                          const verification::OutlineVerification& verification, RunFolder& folder);

}  // namespace flexmorph::cases
