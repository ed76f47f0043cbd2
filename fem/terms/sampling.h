#pragma once

#include "fem/shapes/strain.h"
#include "fem/terms/beam_strains.h"

/// Rules by which terms sample the strains of their elements.
namespace flexmorph::fem {

/// Returns a sampling at Gauss points that integrate polynomials of `degree` in each direction.
/// @param what  tables of the derivatives that the density needs, without rates
std::shared_ptr<const StrainSampling> sample_points(int degree, Tabulate what);

/// Returns the sampling of assumed membrane strains (membrane_invariant.h): the strains of the
/// points of degree 12 are interpolated between the ends and the middle of the element. It serves
/// Green-Lagrange strains only.
std::shared_ptr<const StrainSampling> sample_assumed();

/// Returns the sampling of the sections of a beam. Measures are taken along e₁ and e₂: e₂ along the
/// section of the reference and e₁ perpendicular to it. The points are distributed over the
/// sections, or have all their area on the axis.
std::shared_ptr<const StrainSampling> sample_sections(BeamStrains strains, bool on_axis);

}  // namespace flexmorph::fem
