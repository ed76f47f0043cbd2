#pragma once

#include <string>
#include <vector>

#include "geometry/base.h"

namespace flexmorph::io {

/// Rings of the outline of a plate in a STEP file as polygons whose vertices lie on its edges [m]:
/// of one solid that is extruded along z, or of one face in a plane z = const. The unit is that of
/// the file. Sides of curves stay within kDrawingTolerance.
/// @param thickness  that a solid has along z, within a part in a thousand [m]
/// @throws Error (input) "<path>: ..." for a file that cannot be read, that has more or less than
///         one solid or face, that is not extruded along z, or of another thickness.
std::vector<std::vector<Vec2>> read_step_outline(const std::string& path, double thickness);

}  // namespace flexmorph::io
