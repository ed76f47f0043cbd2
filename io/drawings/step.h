#pragma once

#include <span>
#include <string>

#include "geometry/parts/outline_curves.h"

namespace flexmorph::io {

/// Writes the regions, extruded from z = 0 to `thickness` [m], in STEP (AP214): a solid each, with
/// a plane face to every line of its outline and a cylindrical one to every arc and circle. The
/// file is in millimetres and says so: who reads STEP converts. It is without the time, so that the
/// same design gives the same file.
/// @return why there is no file: OpenCASCADE makes no valid solid of it; empty: it is written
/// @throws Error as write_file().
std::string write_step(const std::string& path, std::span<const CurvedRegion> regions,
                       double thickness);

}  // namespace flexmorph::io
