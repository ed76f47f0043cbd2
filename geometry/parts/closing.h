#pragma once

#include <span>
#include <vector>

#include "geometry/components/outline.h"

/// Fillets at the inner corners of outlines.
namespace flexmorph {

/// Sizes of fillets [m].
struct Fillets {
  double radius = 0;    ///< 0: none
  double thinnest = 0;  ///< smallest width of what fills corners and gaps
};

/// Returns the regions with fillets: the union of the regions R with what is left of their closing
/// after an opening,
///
///   R ∪ ((R ⊕ D_r ⊖ D_r) ⊖ D_t ⊕ D_t),
///
/// within the domain; what is outside of it counts as material of the opening, so that nothing is
/// thin because the border cuts it.
///
/// D_r  disc of the fillets' radius: inner corners get this radius, and gaps below twice of it
/// close D_t  disc of half the smallest width of fillings: blades across gaps do not stay
///
/// (Minkowski sums and differences of GEOS.) Vertices of R stay as they are. The sides of fillets
/// stay within `tolerance` of their circles.
/// @throws Error (numerical) when GEOS finds no result.
std::vector<Region> with_fillets(std::span<const Region> regions, const Region& domain,
                                 const Fillets& fillets, double tolerance);

}  // namespace flexmorph
