#pragma once

#include <string>
#include <vector>

#include "cases/scene/scene.h"

namespace flexmorph::cases {

/// The outline of a part that replaces a design.
struct DrawnPart {
  std::vector<Region> regions;     ///< Connected regions of material with their holes [m].
  std::vector<std::string> notes;  ///< Sentences about contents of the drawing that were ignored.
};

/// Reads the outline of a part that replaces a design from a drawing in the coordinates of the
/// exported design [m]: connected regions of material with their holes, clipped to the design
/// domain. Sides that coincide with borders of the domain or of solid and void regions within 1e-5
/// of the domain's size are moved onto these borders, and so are points that differ from them by
/// rounding.
///
/// DXF: the layers OUTLINE and HOLES if there is a layer OUTLINE; otherwise all layers except
/// DOMAIN, SUPPORTS and LOADS, which contain no outlines in exported drawings, and layers of
/// dimensions and texts. STEP: see
/// io::read_step_outline().
/// @param path  path of a .dxf, .step or .stp file
/// @throws Error (input) "<path>: ..." for a file that cannot be read or gives no unit, for rings
///         that cross, and for outlines that extend beyond the domain or are far smaller than it.
DrawnPart read_part(const std::string& path, const Scene& scene, const BodyDesign& design);

}  // namespace flexmorph::cases
