#pragma once

#include <string>
#include <vector>

#include "geometry/base.h"

namespace flexmorph::io {

/// Returns the rings of the outline of a plate in a STEP file [m]. The plate is one solid that is
/// extruded along z, or one face in a plane z = const. The rings are polygons whose vertices lie on
/// the edges; their sides are within kDrawingTolerance of the edges. The unit is that of the file.
/// @param thickness  thickness that a solid must have along z, to one part in a thousand [m]
/// @throws Error (input) "<path>: ..." for a file that cannot be read, that has more or less than
///         one solid or face, that is not extruded along z, or whose thickness differs.
std::vector<std::vector<Vec2>> read_step_outline(const std::string& path, double thickness);

}  // namespace flexmorph::io
