#pragma once

#include <span>
#include <vector>

#include "geometry/parts/part_mesh.h"

/// Outlines that have vertices where lines meet them, so that no result depends on round-off.
namespace flexmorph {

/// Returns the distance below which two points of a part are merged: 1e-9 of the size of the part
/// [m].
double smallest_distance(std::span<const Region> regions);

/// Returns the lines, cut where horizontal and vertical ones cross each other. Coordinates of their
/// ends that differ by less than `small` [m] become equal. Lines that are neither horizontal nor
/// vertical are not changed.
std::vector<Segment> conforming_lines(std::span<const Segment> lines, double small);

/// Returns a region that has vertices where lines cross its outline or end on it. Vertices that are
/// closer to a line than `small` [m] are moved onto it, and vertices that coincide are merged.
Region with_points_of(const Region& region, std::span<const Segment> lines, double small);

}  // namespace flexmorph
