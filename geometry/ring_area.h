#pragma once

#include <vector>

#include "geometry/base.h"

namespace flexmorph {

/// Returns the area that a ring encloses, positive counterclockwise [m^2]: the shoelace sum about
/// its first vertex.
double signed_area(const std::vector<Vec2>& ring);

}  // namespace flexmorph
