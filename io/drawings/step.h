#pragma once

#include <span>
#include <string>

#include "geometry/parts/outline_curves.h"

namespace flexmorph::io {

/// Writes the regions, extruded from z = 0 to `thickness` [m], in STEP (AP214). Each region is a
/// solid with a plane face for every line of its outline and a cylindrical face for every arc and
/// circle. The file is in millimetres and says so, therefore programs that read it convert the
/// lengths. It contains no time, so that equal designs give equal files.
/// @returns why OpenCASCADE can make no valid solid, in which case no file is written; empty if the
///         file was written
/// @throws Error as write_file().
std::string write_step(const std::string& path, std::span<const CurvedRegion> regions,
                       double thickness);

}  // namespace flexmorph::io
