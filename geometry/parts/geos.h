#pragma once

#include <geos_c.h>

#include <algorithm>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "geometry/parts/picture.h"

/// Polygons of GEOS for the sources of geometry/: no other folder includes this header.
namespace flexmorph::geos {

/// A context of GEOS, whose last message says what went wrong.
class Geos {
 public:
  Geos() : handle_(GEOS_init_r()) {
    GEOSContext_setErrorMessageHandler_r(handle_, &Geos::note, this);
  }
  ~Geos() { GEOS_finish_r(handle_); }
  Geos(const Geos&) = delete;
  Geos& operator=(const Geos&) = delete;

  GEOSContextHandle_t handle() const { return handle_; }
  [[noreturn]] void fail() const {
    throw Error::numerical("fillets of an outline: GEOS says: " +
                           (said_.empty() ? "no result" : said_));
  }

 private:
  static void note(const char* message, void* self) { static_cast<Geos*>(self)->said_ = message; }

  GEOSContextHandle_t handle_;
  std::string said_;
};

/// A polygon or several polygons of GEOS, which a shape owns.
class Shape {
 public:
  /// Functions of this class throw Error (numerical) with the message of GEOS.
  friend Shape union_of(const Geos& geos, std::vector<Shape> pieces);

  Shape(const Geos& geos, GEOSGeometry* geometry) : geos_(&geos), geometry_(geometry) {
    if (geometry == nullptr) geos.fail();
  }
  ~Shape() {
    if (geometry_ != nullptr) GEOSGeom_destroy_r(geos_->handle(), geometry_);
  }
  Shape(Shape&& other) noexcept
      : geos_(other.geos_), geometry_(std::exchange(other.geometry_, nullptr)) {}
  Shape(const Shape&) = delete;
  Shape& operator=(const Shape&) = delete;
  Shape& operator=(Shape&& other) noexcept {
    std::swap(geometry_, other.geometry_);
    return *this;
  }

  const GEOSGeometry* get() const { return geometry_; }
  Shape grown(double by, int segments) const {
    return ring_by_ring(by, [&](const GEOSGeometry* ring, double distance) {
      return GEOSBuffer_r(geos_->handle(), ring, distance, segments);
    });
  }
  /// Without what is thinner than twice the width; corners stay, unless they are very acute.
  Shape without_whiskers(double width) const {
    const auto grow = [&](const GEOSGeometry* ring, double by) {
      constexpr int kQuarter = 8;
      constexpr double kMitre = 5;
      return GEOSBufferWithStyle_r(geos_->handle(), ring, by, kQuarter, GEOSBUF_CAP_ROUND,
                                   GEOSBUF_JOIN_MITRE, kMitre);
    };
    return ring_by_ring(-width, grow).ring_by_ring(width, grow);
  }
  Shape united(const Shape& other) const {
    return polygons_of(GEOSUnion_r(geos_->handle(), geometry_, other.geometry_));
  }
  Shape without(const Shape& other) const {
    return polygons_of(GEOSDifference_r(geos_->handle(), geometry_, other.geometry_));
  }
  Shape common(const Shape& other) const {
    return polygons_of(GEOSIntersection_r(geos_->handle(), geometry_, other.geometry_));
  }
  /// What is in the bounding box of another shape.
  Shape near(const Shape& other) const {
    double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    const GEOSContextHandle_t h = geos_->handle();
    const GEOSGeometry* of = other.geometry_;
    if (GEOSGeom_getExtent_r(h, of, &x0, &y0, &x1, &y1) == 0) geos_->fail();
    return polygons_of(GEOSClipByRect_r(h, geometry_, x0, y0, x1, y1));
  }
  Shape simplified(double tolerance) const {
    return {*geos_, GEOSTopologyPreserveSimplify_r(geos_->handle(), geometry_, tolerance)};
  }
  /// The same of lines, which have no topology to keep.
  Shape only_simplified(double tolerance) const {
    return {*geos_, GEOSSimplify_r(geos_->handle(), geometry_, tolerance)};
  }
  /// With vertices on a lattice: nothing is left of slits and whiskers that are narrower.
  Shape on_lattice(double width) const {
    return polygons_of(GEOSGeom_setPrecision_r(geos_->handle(), geometry_, width, 0));
  }
  int n_pieces() const { return GEOSGetNumGeometries_r(geos_->handle(), geometry_); }
  Shape piece(int k) const {
    return {*geos_,
            GEOSGeom_clone_r(geos_->handle(), GEOSGetGeometryN_r(geos_->handle(), geometry_, k))};
  }
  bool is_valid() const { return GEOSisValid_r(geos_->handle(), geometry_) == 1; }
  double area() const {
    double out = 0;
    if (GEOSArea_r(geos_->handle(), geometry_, &out) == 0) geos_->fail();
    return out;
  }

 private:
  /// Grows what each ring encloses, holes the other way: GEOS needs a time that is quadratic in the
  /// number of rings that it grows at once.
  template <typename Grow>
  Shape ring_by_ring(double by, const Grow& grow) const {
    std::vector<Shape> pieces;
    for (int k = 0; k < n_pieces(); ++k) {
      const GEOSGeometry* polygon = GEOSGetGeometryN_r(geos_->handle(), geometry_, k);
      const Shape outer = filled_ring(GEOSGetExteriorRing_r(geos_->handle(), polygon));
      pieces.push_back({*geos_, grow(outer.geometry_, by)});
      std::vector<Shape> holes;
      for (int h = 0; h < GEOSGetNumInteriorRings_r(geos_->handle(), polygon); ++h) {
        const Shape hole = filled_ring(GEOSGetInteriorRingN_r(geos_->handle(), polygon, h));
        holes.push_back({*geos_, grow(hole.geometry_, -by)});
      }
      if (!holes.empty()) pieces.back() = pieces.back().without(union_of(*geos_, std::move(holes)));
    }
    return union_of(*geos_, std::move(pieces));
  }
  Shape filled_ring(const GEOSGeometry* ring) const {
    return {*geos_, GEOSGeom_createPolygon_r(geos_->handle(),
                                             GEOSGeom_clone_r(geos_->handle(), ring), nullptr, 0)};
  }
  GEOSGeometry* release() { return std::exchange(geometry_, nullptr); }

  /// The polygons of a result: where shapes only touch, it has lines and points, too.
  Shape polygons_of(GEOSGeometry* result) const {
    const Shape all{*geos_, result};
    std::vector<GEOSGeometry*> polygons;
    for (int k = 0; k < all.n_pieces(); ++k) {
      const GEOSGeometry* piece = GEOSGetGeometryN_r(geos_->handle(), all.geometry_, k);
      if (GEOSGeomTypeId_r(geos_->handle(), piece) == GEOS_POLYGON)
        polygons.push_back(GEOSGeom_clone_r(geos_->handle(), piece));
    }
    return {*geos_, GEOSGeom_createCollection_r(geos_->handle(), GEOS_MULTIPOLYGON, polygons.data(),
                                                static_cast<unsigned>(polygons.size()))};
  }

  const Geos* geos_;
  GEOSGeometry* geometry_;
};

/// Returns the union of many shapes.
/// @throws Error (numerical) with the message of GEOS
Shape union_of(const Geos& geos, std::vector<Shape> pieces);

/// Returns a multipolygon of regions, the same whatever the order of regions and holes, and
/// wherever rings begin.
Shape shape_of(const Geos& geos, std::span<const Region> regions);

/// Returns the points of a line.
std::vector<Vec2> points_of(const Geos& geos, const GEOSGeometry* line);
/// Returns the points of a ring, each once.
std::vector<Vec2> ring_points(const Geos& geos, const GEOSGeometry* ring);

}  // namespace flexmorph::geos
