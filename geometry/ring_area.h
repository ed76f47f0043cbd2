#pragma once

#include <vector>

#include "geometry/base.h"

namespace flexmorph {

/// Returns the area that a ring encloses, positive if the ring is counterclockwise [m^2]. It is the
/// shoelace sum about the first vertex.
double signed_area(const std::vector<Vec2>& ring);

}  // namespace flexmorph
