#pragma once

#include <span>
#include <string>
#include <vector>

#include "geometry/components/component.h"
#include "geometry/parts/outline_curves.h"
#include "io/drawings/length_unit.h"

/// Designs for other programs, and components to start from.
namespace flexmorph::io {

/// What else a drawing shows.
struct DrawingLayer {
  std::string name;
  std::vector<std::vector<Vec2>> shapes = {};  ///< points, or lines by their two ends [m]
  std::vector<CurveRing> rings = {};
};

/// Writes a drawing in DXF (R12, ASCII). A ring is a CIRCLE, or a closed POLYLINE whose sides are
/// lines and arcs (bulges); outer ones are on layer OUTLINE, holes on layer HOLES. Coordinates are
/// in the unit, which $INSUNITS says ($MEASUREMENT whether it is metric), in full precision.
/// @throws Error (numerical) as write_file().
void write_dxf(const std::string& path, std::span<const CurvedRegion> regions,
               const LengthUnit& unit, std::span<const DrawingLayer> more = {});

/// STL (ASCII, full precision; the binary form has 7 digits) of the regions extruded from z = 0 to
/// `thickness` [m]: closed surfaces whose edges belong to two facets each. STL knows no units: the
/// name of the solid says which one it is in.
/// @throws Error (numerical) as write_file(), and from triangulate().
void write_stl(const std::string& path, std::span<const Region> regions, double thickness,
               const LengthUnit& unit);

/// components.csv: X0, Y0, half_length, angle, c1, c2, c3 in full precision, one row each.
void write_components_csv(const std::string& path, std::span<const Component> components);

/// Components from such a file.
/// @throws Error (input) that names file, line, column and value.
std::vector<Component> read_components_csv(const std::string& path);

}  // namespace flexmorph::io
