#pragma once

#include <span>
#include <string>
#include <vector>

#include "geometry/components/component.h"
#include "geometry/parts/outline_curves.h"
#include "io/drawings/length_unit.h"

/// Export of designs to other programs, and files of components.
namespace flexmorph::io {

/// Additional contents of a drawing on a layer of their own.
struct DrawingLayer {
  std::string name;                            ///< Name of the layer.
  std::vector<std::vector<Vec2>> shapes = {};  ///< Points, or lines given by their two ends [m].
  std::vector<CurveRing> rings = {};           ///< Closed rings of curves [m].
};

/// Writes a drawing in DXF (R12, ASCII). A ring becomes a CIRCLE, or a closed POLYLINE whose sides
/// are lines and arcs (bulges). Outer rings are on the layer OUTLINE, holes on the layer HOLES.
/// Coordinates have full precision in the given unit, which $INSUNITS names ($MEASUREMENT tells if
/// it is metric).
/// @throws Error (numerical) as write_file().
void write_dxf(const std::string& path, std::span<const CurvedRegion> regions,
               const LengthUnit& unit, std::span<const DrawingLayer> more = {});

/// Writes the regions, extruded from z = 0 to `thickness` [m], in STL (ASCII with full precision,
/// because the binary form has 7 digits). The surfaces are closed, and each edge belongs to two
/// facets. STL has no units, therefore the name of the solid gives the unit.
/// @throws Error (numerical) as write_file() and triangulate().
void write_stl(const std::string& path, std::span<const Region> regions, double thickness,
               const LengthUnit& unit);

/// Writes components to a CSV file with the columns X0, Y0, half_length, angle, c1, c2, c3 in full
/// precision, one row for each component.
void write_components_csv(const std::string& path, std::span<const Component> components);

/// Returns the components of a file that write_components_csv() wrote.
/// @throws Error (input) with file, line, column and value.
std::vector<Component> read_components_csv(const std::string& path);

}  // namespace flexmorph::io
