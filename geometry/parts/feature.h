#pragma once

#include <functional>
#include <span>
#include <vector>

#include "geometry/components/outline.h"

/// How thin a design is: widths of its material and of the void between, by the medial axis.
namespace flexmorph {

/// A place where material or void is narrow: an inscribed disc and two of its contacts.
struct NarrowPlace {
  enum class Kind {
    neck,  ///< contacts opposite each other: the width is a local minimum along the medial axis
    bar,   ///< material between nearly opposite flanks, up to the last disc of an end
    blob   ///< a disc enclosed by its contacts: a local maximum
  };
  Kind kind = Kind::neck;
  bool solid = true;      ///< material, or void
  double width = 0;       ///< diameter of the disc [m]
  Vec2 center{0, 0};      ///< of the disc
  Vec2 a{0, 0}, b{0, 0};  ///< two contacts
};

/// Smallest widths of material and of the void between that a design shall have [m]; 0: any.
struct Widths {
  double solid = 0, gap = 0;
  double of(const NarrowPlace& place) const { return place.solid ? solid : gap; }
  double largest() const { return solid > gap ? solid : gap; }
  bool any() const { return largest() > 0; }
};

/// Narrow places of material and void, narrowest first.
///
/// Medial axis of the outlines (CGAL's segment Delaunay graph). Both material and void have necks
/// and blobs where the distance to the outline has a critical point. Material is thin as well where
/// two contacts of a disc lie within 30 degrees of opposite, so that bars measure what they are
/// where they taper, and free ends by the last disc between their flanks; ordinary corners and
/// bumps are no features. A corner of less than 30 degrees, and pieces that share one vertex only,
/// have width 0. Against the domain's border 15 degrees count instead of 30: a bar that the border
/// cuts is no thinner for it, a wedge along the border is. Void counts between material within the
/// domain.
///
/// Exact for the polygons it is given; outlines within t of curved ones give widths within 2 t. The
/// same bit for bit wherever rings begin and whatever their order.
///
/// @param regions  as unite() returns them
/// @param domain   what they are clipped to
/// @param limit    only places narrower than that [m]
std::vector<NarrowPlace> narrow_places(std::span<const Region> regions, const Region& domain,
                                       double limit);

/// Smallest widths of material and void; infinite where there are none.
struct Features {
  double solid, gap;  ///< [m]
};
/// @param counts  which places do, if not all; asked of some of them only
Features smallest_features(std::span<const Region> regions, const Region& domain,
                           const std::function<bool(const NarrowPlace&)>& counts = {});

}  // namespace flexmorph
