#pragma once

#include <string>
#include <vector>

#include "cases/scene/scene.h"

namespace flexmorph::cases {

/// Reads the outline of a part that replaces a design from a drawing in the coordinates of the
/// exported design [m]: connected regions of material with their holes, clipped to the design
/// domain. Sides that coincide with borders of the domain or of solid and void regions within 1e-5
/// of the domain's size are moved onto these borders, and so are points that differ from them by
/// rounding.
///
/// DXF: the layers OUTLINE and HOLES if there is a layer OUTLINE; otherwise all layers except
/// DOMAIN, SUPPORTS and LOADS, which contain no outlines in exported drawings. STEP: see
/// io::read_step_outline().
/// @param path  path of a .dxf, .step or .stp file
/// @throws Error (input) "<path>: ..." for a file that cannot be read or gives no unit, for rings
///         that cross, and for outlines that extend beyond the domain or are far smaller than it.
std::vector<Region> read_part(const std::string& path, const Scene& scene,
                              const BodyDesign& design);

}  // namespace flexmorph::cases
