#pragma once

#include <span>
#include <vector>

#include "geometry/parts/feature.h"
#include "geometry/parts/part_mesh.h"

namespace flexmorph {

/// Returns the unresolved gaps between material and lines on which it should end, the narrowest
/// first. Each gap is a location of void with the contact `a` on the line and the contact `b` on
/// the outline. `b` is the vertex (or the middle between equally far vertices) whose distance to
/// the line is a local minimum along the outline. Gaps with other material in between are omitted.
///
/// A vertex that is closer to a line than 1e-9 of the length of the line touches it. A vertex whose
/// nearest point is an end of the line, beside the line, has no gap. The result is exact for the
/// given polygons.
///
/// @param regions  regions as unite() returns them
/// @param lines    lines of which each has material on one side only
/// @param limit    width below which a gap is returned [m]
std::vector<LengthScaleViolation> line_gaps(std::span<const Region> regions,
                                            std::span<const Segment> lines, double limit);

}  // namespace flexmorph
