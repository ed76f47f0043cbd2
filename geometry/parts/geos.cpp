#include "geometry/parts/geos.h"

#include <algorithm>

namespace flexmorph::geos {

Shape union_of(const Geos& geos, std::vector<Shape> pieces) {
  std::vector<GEOSGeometry*> all;
  for (Shape& piece : pieces) all.push_back(piece.release());
  const Shape together{
      geos, GEOSGeom_createCollection_r(geos.handle(), GEOS_GEOMETRYCOLLECTION, all.data(),
                                        static_cast<unsigned>(all.size()))};
  return together.polygons_of(GEOSUnaryUnion_r(geos.handle(), together.geometry_));
}

namespace {

bool is_before(const Vec2& a, const Vec2& b) {
  return std::pair(a.x(), a.y()) < std::pair(b.x(), b.y());
}

/// Returns the ring rotated so that it begins with its leftmost vertex (the lowest of several).
std::vector<Vec2> from_first_vertex(std::vector<Vec2> ring) {
  std::rotate(ring.begin(), std::min_element(ring.begin(), ring.end(), is_before), ring.end());
  return ring;
}

GEOSGeometry* ring_of(const Geos& geos, const std::vector<Vec2>& ring) {
  const auto n = static_cast<unsigned>(ring.size());
  GEOSCoordSequence* points = GEOSCoordSeq_create_r(geos.handle(), n + 1, 2);
  for (unsigned k = 0; k <= n; ++k)
    GEOSCoordSeq_setXY_r(geos.handle(), points, k, ring[k % n].x(), ring[k % n].y());
  return GEOSGeom_createLinearRing_r(geos.handle(), points);
}

}  // namespace

Shape shape_of(const Geos& geos, std::span<const Region> regions) {
  const auto earlier = [](const std::vector<Vec2>& a, const std::vector<Vec2>& b) {
    return is_before(a.front(), b.front());
  };
  std::vector<Region> sorted;
  for (const Region& r : regions) {
    Region& own = sorted.emplace_back(Region{from_first_vertex(r.outer), {}});
    for (const std::vector<Vec2>& hole : r.holes) own.holes.push_back(from_first_vertex(hole));
    std::sort(own.holes.begin(), own.holes.end(), earlier);
  }
  std::sort(sorted.begin(), sorted.end(),
            [&](const Region& a, const Region& b) { return earlier(a.outer, b.outer); });
  std::vector<GEOSGeometry*> pieces;
  for (const Region& r : sorted) {
    std::vector<GEOSGeometry*> holes;
    for (const std::vector<Vec2>& hole : r.holes) holes.push_back(ring_of(geos, hole));
    pieces.push_back(GEOSGeom_createPolygon_r(geos.handle(), ring_of(geos, r.outer), holes.data(),
                                              static_cast<unsigned>(holes.size())));
  }
  return {geos, GEOSGeom_createCollection_r(geos.handle(), GEOS_MULTIPOLYGON, pieces.data(),
                                            static_cast<unsigned>(pieces.size()))};
}

std::vector<Vec2> points_of(const Geos& geos, const GEOSGeometry* line) {
  const GEOSCoordSequence* sequence = GEOSGeom_getCoordSeq_r(geos.handle(), line);
  unsigned n = 0;
  if (sequence == nullptr || GEOSCoordSeq_getSize_r(geos.handle(), sequence, &n) == 0) geos.fail();
  std::vector<Vec2> out(n);
  for (unsigned k = 0; k < n; ++k)
    GEOSCoordSeq_getXY_r(geos.handle(), sequence, k, &out[k].x(), &out[k].y());
  return out;
}

std::vector<Vec2> ring_points(const Geos& geos, const GEOSGeometry* ring) {
  std::vector<Vec2> out = points_of(geos, ring);
  if (!out.empty()) out.pop_back();
  return out;
}

}  // namespace flexmorph::geos
