#pragma once

#include <span>
#include <vector>

#include "geometry/parts/feature.h"
#include "geometry/parts/part_mesh.h"

namespace flexmorph {

/// Where material ends just short of a line that should hold it: places of void, narrowest first,
/// with one contact `a` on the line and the other one, `b`, the point of the outline that is
/// nearest to the line among its neighbours.
///
/// What is nearer to a line than 1e-9 of its length touches it; what is beside its ends has no gap
/// to it. Exact for the polygons it is given.
///
/// @param regions  as unite() returns them
/// @param lines    no material lies on both sides of one
/// @param limit    only gaps narrower than that [m]
std::vector<NarrowPlace> line_gaps(std::span<const Region> regions, std::span<const Segment> lines,
                                   double limit);

}  // namespace flexmorph
