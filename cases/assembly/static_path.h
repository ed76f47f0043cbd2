#pragma once

#include "cases/scene/scene.h"
#include "fem/solve/statics.h"

namespace flexmorph::cases {

/// Returns the settings of the path of equilibria of a [static] analysis.
fem::StaticSettings static_settings(const StaticAnalysis& analysis);

/// Prepares the model of a [static] analysis for its path: loads and temperatures that are constant
/// along the path are applied in steps, the others have the factor 0 and are selected for
/// Model::scale_loads().
/// @param x  in: undeformed state; out: equilibrium at the start of the path
/// @throws Error (numerical) as fem::solve_static()
void begin_static_path(const Scene& scene, fem::Workspace& model, fem::State& x);

}  // namespace flexmorph::cases
