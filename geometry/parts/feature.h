#pragma once

#include <functional>
#include <span>
#include <vector>

#include "geometry/components/outline.h"

/// The minimum length scale of a design: local widths of its material and of the void between its
/// parts, measured by the medial axis.
namespace flexmorph {

/// A location where material or void is narrow, given by an inscribed disc and two of its contact
/// points with the outline. It violates the minimum length scale if its width is below the limit.
struct LengthScaleViolation {
  /// Shape of the narrow location.
  enum class Kind {
    neck,  ///< The contacts are opposite: the width is a local minimum along the medial axis.
    bar,   ///< Material between nearly opposite flanks, up to the last disc at a free end.
    blob   ///< The contacts enclose the disc: the width is a local maximum.
  };
  Kind kind = Kind::neck;  ///< Shape of the narrow location.
  bool solid = true;       ///< True if the material is narrow, false if the void is.
  double width = 0;        ///< Diameter of the disc [m].
  Vec2 center{0, 0};       ///< Center of the disc [m].
  Vec2 a{0, 0}, b{0, 0};   ///< Two contact points of the disc [m].
};

/// Minimum length scales of a design for its material and for the void between its parts [m]; 0
/// means no limit.
struct MinimumWidths {
  double solid = 0, gap = 0;  ///< Smallest width of the material and of the void [m].

  /// Returns the limit that applies to a narrow location [m].
  double of(const LengthScaleViolation& location) const { return location.solid ? solid : gap; }
  /// Returns the larger one of both limits [m].
  double largest() const { return solid > gap ? solid : gap; }
  /// Returns true if there is a limit.
  bool any() const { return largest() > 0; }
};

/// Returns the locations where material or void is narrower than a limit, the narrowest first.
///
/// The widths come from the medial axis of the outlines (segment Delaunay graph of CGAL). Material
/// and void have necks and blobs where the distance to the outline has a critical point. Material
/// also counts as narrow where two contacts of a disc are within 30 degrees of opposite. Therefore
/// bars are measured where they taper, and free ends by the last disc between their flanks, whereas
/// ordinary corners and bumps are no features. A corner of less than 30 degrees and a vertex that
/// two regions share have the width 0. Against the border of the domain the limit is 15 degrees
/// instead of 30: a bar that the border cuts is not narrow for that reason, a wedge along the
/// border is. Void counts only between material and within the domain.
///
/// The result is exact for the given polygons; polygons within t of curved outlines give widths
/// within 2 t. The result is the same bit for bit for every order of the rings and of their first
/// vertices.
///
/// @param regions  regions as unite() returns them
/// @param domain   domain to which the regions are clipped
/// @param limit    width below which a location is returned [m]
std::vector<LengthScaleViolation> length_scale_violations(std::span<const Region> regions,
                                                          const Region& domain, double limit);

/// Smallest widths of material and void; infinite where there is none.
struct Features {
  double solid, gap;  ///< Smallest width of the material and of the void [m].
};
/// Returns the smallest widths of material and void among the locations that count.
/// @param counts  returns true if a location counts; empty means that all count. It is called only
///         for locations that are narrower than the smallest width found before.
Features smallest_features(std::span<const Region> regions, const Region& domain,
                           const std::function<bool(const LengthScaleViolation&)>& counts = {});

}  // namespace flexmorph
