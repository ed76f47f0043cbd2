#pragma once

#include <span>
#include <string>

#include "geometry/outline.h"

namespace flexmorph::io {

/// STEP (AP214) of the regions extruded from z = 0 to `thickness` [m]: a solid each, with a plane
/// face to every side of its outline. In millimetres, and the file says so: who reads STEP
/// converts. Without the time, so that the same design gives the same file.
/// @return why there is no file: OpenCASCADE makes no solid of it; empty: it is written
/// @throws Error as write_file().
std::string write_step(const std::string& path, std::span<const Region> regions, double thickness);

}  // namespace flexmorph::io
