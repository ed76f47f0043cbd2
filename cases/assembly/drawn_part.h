#pragma once

#include <string>
#include <vector>

#include "cases/scene/scene.h"

namespace flexmorph::cases {

/// Outline of a part that is to stand in place of a design, from a drawing in the coordinates of
/// the exported design [m]: pieces of material with their holes, clipped to the design domain.
/// Sides that run along borders of the domain or of solid and void regions to 1e-5 of the domain's
/// size, and points that are there but for rounding, are put onto them.
///
/// DXF: the layers OUTLINE and HOLES where there is an OUTLINE; otherwise all layers but DOMAIN,
/// SUPPORTS and LOADS, on which exported drawings show what is no outline. STEP: see
/// io::read_step_outline().
/// @param path  of a .dxf, .step or .stp file
/// @throws Error (input) "<path>: ..." for a file that cannot be read or says no unit, rings that
///         cross, and outlines that reach beyond the domain or are far smaller than it.
std::vector<Region> read_part(const std::string& path, const Scene& scene,
                              const BodyDesign& design);

}  // namespace flexmorph::cases
