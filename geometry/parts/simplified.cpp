#include "geometry/parts/simplified.h"

#include <algorithm>

#include "geometry/parts/geos.h"
#include "geometry/ring_area.h"

namespace flexmorph {

using geos::Geos;
using geos::Shape;

std::vector<Vec2> simplified(const std::vector<Vec2>& ring, double tolerance) {
  const Geos geos;
  const Region region{ring, {}};
  const Shape shape = shape_of(geos, {&region, 1}).simplified(tolerance);
  std::vector<Vec2> out = ring_points(
      geos,
      GEOSGetExteriorRing_r(geos.handle(), GEOSGetGeometryN_r(geos.handle(), shape.get(), 0)));
  if ((signed_area(out) > 0) != (signed_area(ring) > 0)) std::reverse(out.begin(), out.end());
  return out;
}

std::vector<Vec2> simplified_line(const std::vector<Vec2>& line, double tolerance) {
  const Geos geos;
  const auto n = static_cast<unsigned>(line.size());
  GEOSCoordSequence* points = GEOSCoordSeq_create_r(geos.handle(), n, 2);
  for (unsigned k = 0; k < n; ++k)
    GEOSCoordSeq_setXY_r(geos.handle(), points, k, line[k].x(), line[k].y());
  const Shape whole{geos, GEOSGeom_createLineString_r(geos.handle(), points)};
  return points_of(geos, whole.only_simplified(tolerance).get());
}

}  // namespace flexmorph
