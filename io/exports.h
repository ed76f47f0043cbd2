#pragma once

#include <span>
#include <string>
#include <vector>

#include "geometry/component.h"
#include "geometry/outline.h"

/// Designs for other programs, and components to start from.
namespace flexmorph::io {

/// DXF (R12, ASCII) in metres: every ring a closed polyline, outer ones on layer OUTLINE, holes on
/// layer HOLES. Coordinates in full precision.
/// @throws Error (input) when the file cannot be written.
void write_dxf(const std::string& path, std::span<const Region> regions);

/// STL (ASCII, full precision; the binary form has 7 digits) of the regions extruded from z = 0 to
/// `thickness` [m]: closed surfaces whose edges belong to two facets each.
/// @throws Error (input) when the file cannot be written; Error (numerical) from triangulate().
void write_stl(const std::string& path, std::span<const Region> regions, double thickness);

/// components.csv: X0, Y0, half_length, angle, c1, c2, c3 in full precision, one row each.
void write_components_csv(const std::string& path, std::span<const Component> components);

/// Components from such a file.
/// @throws Error (input) that names file, line, column and value.
std::vector<Component> read_components_csv(const std::string& path);

}  // namespace flexmorph::io
