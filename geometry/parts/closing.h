#pragma once

#include <span>
#include <vector>

#include "geometry/components/outline.h"

/// Fillets at the reentrant corners of outlines.
namespace flexmorph {

/// Sizes of fillets [m].
struct Fillets {
  double radius = 0;    ///< Radius of the fillets [m]; 0 means no fillets.
  double thinnest = 0;  ///< Smallest width of the material that fills corners and gaps [m].
};

/// Returns the regions with fillets: the union of the regions R with the opening of their closing,
///
///   R ∪ ((R ⊕ D_r ⊖ D_r) ⊖ D_t ⊕ D_t),
///
/// within the domain. Outside the domain everything counts as material in the opening, so that no
/// material is removed only because the border of the domain cuts it.
///
///   D_r  disc of the radius of the fillets; it rounds reentrant corners and closes gaps that are
///        narrower than two radii
///   D_t  disc of half the smallest width of fillings; it removes thin walls across gaps
///
/// Minkowski sums and differences are computed by GEOS. Vertices of R are kept. The sides of
/// fillets are within `tolerance` of their circles [m].
/// @throws Error (numerical) when GEOS returns no result.
std::vector<Region> with_fillets(std::span<const Region> regions, const Region& domain,
                                 const Fillets& fillets, double tolerance);

}  // namespace flexmorph
