#include "geometry/parts/closing.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "geometry/parts/geos.h"
#include "geometry/parts/simplified.h"
#include "geometry/ring_area.h"

namespace flexmorph {
namespace {

using geos::Geos;
using geos::ring_points;
using geos::Shape;
using geos::shape_of;

/// Tolerances as fractions of the radius of the fillets: a vertex of the result within
/// kSameDirection of a given vertex is replaced by it, and a vertex within kStraight of the line
/// through its neighbours is removed.
constexpr double kSameDirection = 2e-3, kStraight = 1e-6;
/// Width of the lattice on which vertices of results lie, as a fraction of the radius.
constexpr double kLattice = 1e-9;
/// Vertices within this distance of the border of the domain are on it, as a fraction of the
/// radius.
constexpr double kOnBorder = 1e-6;
/// Half the width below which material is an artefact, as a fraction of the tolerance. Such
/// artefacts arise because discs are replaced by polygons.
constexpr double kWhisker = 0.5;
/// Returns the number of sides per 90 degrees of a circle that are within the tolerance.
int segments(double radius, double tolerance) {
  const double part = std::min(tolerance / radius, 0.1);
  return std::max(16, static_cast<int>(std::ceil(0.25 * std::numbers::pi / std::acos(1 - part))));
}

/// Fills reentrant corners and gaps of shapes within a domain.
class Filling {
 public:
  Filling(const Geos& geos, const Shape& domain, const Fillets& fillets, double tolerance)
      : geos_(geos),
        domain_(domain),
        radius_(fillets.radius),
        thin_(0.5 * fillets.thinnest),
        tolerance_(tolerance),
        sides_(segments(std::max(fillets.radius, thin_), tolerance)),
        around_(domain.grown(3 * thin_, 1).without(domain)) {}

  Shape of(const Shape& given) const {
    const Shape closed = given.grown(radius_, sides_).grown(-radius_, sides_);
    Shape filled = rounded(given, closed);
    std::vector<Shape> all = bridges_of(closed, filled);
    if (all.empty()) return filled;
    all.push_back(std::move(filled));
    const Shape joined = union_of(geos_, std::move(all));
    return rounded(joined, joined.grown(radius_, sides_).grown(-radius_, sides_));
  }

 private:
  /// Returns the union of a shape with the parts of its closing that are not thin.
  Shape rounded(const Shape& given, const Shape& closed) const {
    const Shape opened = closed.united(around_).grown(-thin_, sides_).grown(thin_, sides_);
    // Material outside the domain leaves whiskers along the border.
    return given.united(opened).common(domain_).without_whiskers(kWhisker * tolerance_);
  }

  /// Returns thin walls that bridge gaps, thickened to the smallest width of a filling. A thin wall
  /// that touches the filled shape on one side only is the tip of a filling and is omitted.
  std::vector<Shape> bridges_of(const Shape& closed, const Shape& filled) const {
    constexpr double kReach = 1e-3, kTiny = 1e-4;  // fractions of the radius, and of its square
    std::vector<Shape> out;
    const Shape left = closed.without(filled).common(domain_);
    for (int k = 0; k < left.n_connected_regions(); ++k) {
      Shape blade = left.piece(k);
      if (blade.area() < kTiny * radius_ * radius_) continue;
      const Shape reached = blade.grown(kReach * radius_, 4);
      const Shape contacts = reached.common(filled.near(reached));
      if (contacts.n_connected_regions() > 1) out.push_back(blade.grown(thin_, sides_));
    }
    return out;
  }

  const Geos& geos_;
  const Shape& domain_;
  double radius_, thin_, tolerance_;
  int sides_;
  Shape around_;
};

Shape filled(const Geos& geos, std::span<const Region> regions, const Shape& domain,
             const Fillets& fillets, double tolerance) {
  const Shape given = shape_of(geos, regions);
  return Filling(geos, domain, fillets, tolerance).of(given).on_lattice(kLattice * fillets.radius);
}

/// The outline of a domain, with a test for vertices that lie on it.
class Border {
 public:
  /// Prepares the outline.
  /// @param reach  distance within which a vertex is on the outline [m]
  Border(const Geos& geos, const Shape& domain, double reach)
      : geos_(&geos),
        outline_(geos, GEOSBoundary_r(geos.handle(), domain.get())),
        prepared_(GEOSPrepare_r(geos.handle(), outline_.get())),
        reach_(reach) {
    if (prepared_ == nullptr) geos.fail();
  }
  ~Border() { GEOSPreparedGeom_destroy_r(geos_->handle(), prepared_); }
  Border(const Border&) = delete;
  Border& operator=(const Border&) = delete;

  bool has(const Vec2& p) const {
    const Shape point{*geos_, GEOSGeom_createPointFromXY_r(geos_->handle(), p.x(), p.y())};
    return GEOSPreparedDistanceWithin_r(geos_->handle(), prepared_, point.get(), reach_) == 1;
  }

 private:
  const Geos* geos_;
  Shape outline_;
  const GEOSPreparedGeometry* prepared_;
  double reach_;
};

/// Vertices of the given regions, sorted by x, for the search by position.
class Vertices {
 public:
  explicit Vertices(std::span<const Region> regions) {
    for (const Region& r : regions) {
      add(r.outer);
      for (const std::vector<Vec2>& hole : r.holes) add(hole);
    }
    std::sort(all_.begin(), all_.end(), [](const Vec2& a, const Vec2& b) {
      return std::pair(a.x(), a.y()) < std::pair(b.x(), b.y());
    });
  }

  /// Returns the nearest vertex within a distance, or the point itself if there is none.
  Vec2 near(const Vec2& p, double distance) const {
    Vec2 out = p;
    auto at = std::lower_bound(all_.begin(), all_.end(), p.x() - distance,
                               [](const Vec2& v, double x) { return v.x() < x; });
    for (; at != all_.end() && at->x() <= p.x() + distance; ++at)
      if (const double d = (*at - p).norm(); d <= distance) {
        distance = d;
        out = *at;
      }
    return out;
  }

 private:
  void add(const std::vector<Vec2>& ring) { all_.insert(all_.end(), ring.begin(), ring.end()); }

  std::vector<Vec2> all_;
};

/// Returns a ring with fewer vertices that keeps all vertices on the border of the domain. Thus a
/// round end that reaches beyond the border by less than the tolerance remains connected to it.
std::vector<Vec2> simplified_between(std::vector<Vec2> ring, const Border& border,
                                     double tolerance) {
  std::vector<std::size_t> kept;
  for (std::size_t k = 0; k < ring.size(); ++k)
    if (border.has(ring[k])) kept.push_back(k);
  if (kept.empty()) return simplified(ring, tolerance);
  std::vector<Vec2> out;
  for (std::size_t k = 0; k < kept.size(); ++k) {
    std::vector<Vec2> chain;
    const std::size_t end = k + 1 < kept.size() ? kept[k + 1] : kept[0] + ring.size();
    for (std::size_t at = kept[k]; at <= end; ++at) chain.push_back(ring[at % ring.size()]);
    if (chain.size() > 2) chain = simplified_line(chain, tolerance);
    out.insert(out.end(), chain.begin(), chain.end() - 1);
  }
  return out;
}

/// Returns a ring of GEOS in which vertices near those of the given regions are replaced by them,
/// and vertices on straight lines are removed.
std::vector<Vec2> cleaned(const std::vector<Vec2>& ring, const Vertices& vertices, double radius) {
  std::vector<Vec2> snapped;
  for (const Vec2& p : ring) {
    const Vec2 at = vertices.near(p, kSameDirection * radius);
    if (snapped.empty() || at != snapped.back()) snapped.push_back(at);
  }
  while (snapped.size() > 1 && snapped.front() == snapped.back()) snapped.pop_back();
  std::vector<Vec2> out;
  for (size_t k = 0; k < snapped.size(); ++k) {
    const Vec2 &before = out.empty() ? snapped.back() : out.back(), &p = snapped[k],
               &after = snapped[(k + 1) % snapped.size()];
    const Vec2 along = after - before;
    const double off = std::abs(along.x() * (p - before).y() - along.y() * (p - before).x());
    const bool between = (p - before).dot(along) > 0 && (after - p).dot(along) > 0;
    if (!between || off > kStraight * radius * along.norm()) out.push_back(p);
  }
  return out;
}

/// Sets the sense of rotation. Returns false if the ring has no area.
bool orient(std::vector<Vec2>& ring, bool outer) {
  if (ring.size() < 3) return false;
  const double a = signed_area(ring);
  if ((a > 0) != outer) std::reverse(ring.begin(), ring.end());
  return a != 0;
}

/// Returns the region of rings after setting their senses of rotation; an empty region if the outer
/// ring has no area.
Region oriented(std::vector<std::vector<Vec2>> rings) {
  Region out;
  if (!orient(rings[0], true)) return out;
  out.outer = std::move(rings[0]);
  for (std::size_t k = 1; k < rings.size(); ++k)
    if (orient(rings[k], false)) out.holes.push_back(std::move(rings[k]));
  return out;
}

/// Returns the region of a polygon of GEOS without the steps, lower than the tolerance, that the
/// sides of an opening cause beside the sides of the shape. Vertices are replaced by those of the
/// given regions if the polygon remains valid.
Region region_of(const Geos& geos, const GEOSGeometry* piece, const Vertices& vertices,
                 const Border& border, double radius, double tolerance) {
  std::vector<std::vector<Vec2>> rings = {
      ring_points(geos, GEOSGetExteriorRing_r(geos.handle(), piece))};
  for (int h = 0; h < GEOSGetNumInteriorRings_r(geos.handle(), piece); ++h)
    rings.push_back(ring_points(geos, GEOSGetInteriorRingN_r(geos.handle(), piece, h)));
  const std::vector<std::vector<Vec2>> given = rings;
  for (std::vector<Vec2>& ring : rings)
    ring = cleaned(simplified_between(ring, border, 0.5 * tolerance), vertices, radius);
  Region out = oriented(std::move(rings));
  if (!out.outer.empty() && !shape_of(geos, {&out, 1}).is_valid()) out = oriented(given);
  return out;
}

}  // namespace

std::vector<Region> with_fillets(std::span<const Region> regions, const Region& domain,
                                 const Fillets& fillets, double tolerance) {
  if (!(fillets.radius > 0) || regions.empty()) return {regions.begin(), regions.end()};
  const Geos geos;
  const Shape within = shape_of(geos, {&domain, 1});
  const Border border(geos, within, kOnBorder * fillets.radius);
  const Shape shape = filled(geos, regions, within, fillets, tolerance);
  std::vector<Region> given(regions.begin(), regions.end());
  given.push_back(domain);
  const Vertices vertices(given);
  std::vector<Region> out;
  const int n = GEOSGetNumGeometries_r(geos.handle(), shape.get());
  const Shape material = shape_of(geos, regions);
  for (int k = 0; k < n; ++k) {
    // Offsets with polygons instead of discs leave tiny regions at corners of the domain.
    if (n > 1 && !(shape.piece(k).common(material).area() > 0)) continue;
    const GEOSGeometry* piece = GEOSGetGeometryN_r(geos.handle(), shape.get(), k);
    Region region = region_of(geos, piece, vertices, border, fillets.radius, tolerance);
    if (!region.outer.empty()) out.push_back(std::move(region));
  }
  return out;
}

}  // namespace flexmorph
