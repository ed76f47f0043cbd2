#pragma once

#include <geos_c.h>

#include <algorithm>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "geometry/parts/picture.h"

/// Polygons of the library GEOS for the sources of geometry/. No other folder includes this header.
namespace flexmorph::geos {

/// A context of GEOS, which stores the last error message.
class Geos {
 public:
  Geos() : handle_(GEOS_init_r()) {
    GEOSContext_setErrorMessageHandler_r(handle_, &Geos::note, this);
  }
  ~Geos() { GEOS_finish_r(handle_); }
  Geos(const Geos&) = delete;
  Geos& operator=(const Geos&) = delete;

  /// Returns the handle that functions of GEOS need.
  GEOSContextHandle_t handle() const { return handle_; }
  /// Throws an error with the last message of GEOS.
  /// @throws Error (numerical) always.
  [[noreturn]] void fail() const {
    throw Error::numerical("fillets of an outline: GEOS failed: " +
                           (said_.empty() ? "it returned no result" : said_));
  }

 private:
  static void note(const char* message, void* self) { static_cast<Geos*>(self)->said_ = message; }

  GEOSContextHandle_t handle_;
  std::string said_;
};

/// One or several polygons of GEOS. The shape owns them. Its functions throw Error (numerical) with
/// the message of GEOS.
class Shape {
 public:
  friend Shape union_of(const Geos& geos, std::vector<Shape> pieces);

  /// Takes the ownership of a geometry.
  /// @throws Error (numerical) when `geometry` is null.
  Shape(const Geos& geos, GEOSGeometry* geometry) : geos_(&geos), geometry_(geometry) {
    if (geometry == nullptr) geos.fail();
  }
  ~Shape() {
    if (geometry_ != nullptr) GEOSGeom_destroy_r(geos_->handle(), geometry_);
  }
  /// Takes the polygons of another shape, which is empty afterwards.
  Shape(Shape&& other) noexcept
      : geos_(other.geos_), geometry_(std::exchange(other.geometry_, nullptr)) {}
  Shape(const Shape&) = delete;
  Shape& operator=(const Shape&) = delete;
  Shape& operator=(Shape&& other) noexcept {
    std::swap(geometry_, other.geometry_);
    return *this;
  }

  /// Returns the geometry; the shape still owns it.
  const GEOSGeometry* get() const { return geometry_; }
  /// Returns the shape offset outwards by a distance [m] (inwards if it is negative); arcs have
  /// `segments` sides per 90 degrees.
  Shape grown(double by, int segments) const {
    return ring_by_ring(by, [&](const GEOSGeometry* ring, double distance) {
      return GEOSBuffer_r(geos_->handle(), ring, distance, segments);
    });
  }
  /// Returns the shape without parts that are thinner than twice the width [m]. Corners are kept
  /// unless they are very acute.
  Shape without_whiskers(double width) const {
    const auto grow = [&](const GEOSGeometry* ring, double by) {
      constexpr int kQuarter = 8;
      constexpr double kMitre = 5;
      return GEOSBufferWithStyle_r(geos_->handle(), ring, by, kQuarter, GEOSBUF_CAP_ROUND,
                                   GEOSBUF_JOIN_MITRE, kMitre);
    };
    return ring_by_ring(-width, grow).ring_by_ring(width, grow);
  }
  /// Returns the union with another shape.
  Shape united(const Shape& other) const {
    return polygons_of(GEOSUnion_r(geos_->handle(), geometry_, other.geometry_));
  }
  /// Returns the shape without the area of another one.
  Shape without(const Shape& other) const {
    return polygons_of(GEOSDifference_r(geos_->handle(), geometry_, other.geometry_));
  }
  /// Returns the intersection with another shape.
  Shape common(const Shape& other) const {
    return polygons_of(GEOSIntersection_r(geos_->handle(), geometry_, other.geometry_));
  }
  /// Returns the part of the shape in the bounding box of another shape.
  Shape near(const Shape& other) const {
    double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    const GEOSContextHandle_t h = geos_->handle();
    const GEOSGeometry* of = other.geometry_;
    if (GEOSGeom_getExtent_r(h, of, &x0, &y0, &x1, &y1) == 0) geos_->fail();
    return polygons_of(GEOSClipByRect_r(h, geometry_, x0, y0, x1, y1));
  }
  /// Returns the shape with fewer vertices, within a tolerance [m] and with the same topology.
  Shape simplified(double tolerance) const {
    return {*geos_, GEOSTopologyPreserveSimplify_r(geos_->handle(), geometry_, tolerance)};
  }
  /// Returns lines with fewer vertices, within a tolerance [m], without a check of their topology.
  Shape only_simplified(double tolerance) const {
    return {*geos_, GEOSSimplify_r(geos_->handle(), geometry_, tolerance)};
  }
  /// Returns the shape with vertices on a lattice of a width [m]. Slits and whiskers narrower than
  /// the width vanish.
  Shape on_lattice(double width) const {
    return polygons_of(GEOSGeom_setPrecision_r(geos_->handle(), geometry_, width, 0));
  }
  /// Returns the number of polygons.
  int n_connected_regions() const { return GEOSGetNumGeometries_r(geos_->handle(), geometry_); }
  /// Returns a copy of the polygon k.
  Shape piece(int k) const {
    return {*geos_,
            GEOSGeom_clone_r(geos_->handle(), GEOSGetGeometryN_r(geos_->handle(), geometry_, k))};
  }
  /// Returns true if the polygons are valid (rings neither cross nor overlap).
  bool is_valid() const { return GEOSisValid_r(geos_->handle(), geometry_) == 1; }
  /// Returns the area of all polygons [m^2].
  double area() const {
    double out = 0;
    if (GEOSArea_r(geos_->handle(), geometry_, &out) == 0) geos_->fail();
    return out;
  }

 private:
  /// Offsets the polygon of every ring separately, holes with the opposite sign. The time that GEOS
  /// needs is quadratic in the number of rings that it offsets together.
  template <typename Grow>
  Shape ring_by_ring(double by, const Grow& grow) const {
    std::vector<Shape> pieces;
    for (int k = 0; k < n_connected_regions(); ++k) {
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

  /// Returns the polygons of a result. Where shapes only touch, the result contains lines and
  /// points, too.
  Shape polygons_of(GEOSGeometry* result) const {
    const Shape all{*geos_, result};
    std::vector<GEOSGeometry*> polygons;
    for (int k = 0; k < all.n_connected_regions(); ++k) {
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

/// Returns the multipolygon of regions. It does not depend on the order of regions and holes and on
/// the first vertices of rings.
Shape shape_of(const Geos& geos, std::span<const Region> regions);

/// Returns the points of a line [m].
std::vector<Vec2> points_of(const Geos& geos, const GEOSGeometry* line);
/// Returns the points of a ring [m]; the first one is not repeated.
std::vector<Vec2> ring_points(const Geos& geos, const GEOSGeometry* ring);

}  // namespace flexmorph::geos
