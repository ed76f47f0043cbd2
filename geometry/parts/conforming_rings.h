#pragma once

#include <span>
#include <vector>

#include "geometry/parts/part_mesh.h"

/// Outlines that have vertices where lines meet them, so that nothing is left to round-off.
namespace flexmorph {

/// Points of a part that are nearer to each other are one: 1e-9 of its size [m].
double smallest_distance(std::span<const Region> regions);

/// The lines, cut where they cross each other; coordinates of their ends that differ by less than
/// `small` are the same. Those that are neither horizontal nor vertical stay as they are.
std::vector<Segment> conforming_lines(std::span<const Segment> lines, double small);

/// A region with vertices where lines cross its outline or end on it; vertices that are nearer to a
/// line than `small` lie on it. Vertices that coincide are one.
Region with_points_of(const Region& region, std::span<const Segment> lines, double small);

}  // namespace flexmorph
