#pragma once

#include "fem/shapes/strain.h"
#include "fem/terms/beam_strains.h"

/// The ways in which terms sample the strains of their elements.
namespace flexmorph::fem {

/// At Gauss points that integrate polynomials of `degree` each way.
/// @param what  tables of the derivatives that the density asks for, without rates
std::shared_ptr<const StrainSampling> sample_points(int degree, Tabulate what);

/// Assumed strains of a membrane (membrane_invariant.h): those of the points of degree 12,
/// interpolated between the ends and the middle of the element. Green and Lagrange's strains only.
std::shared_ptr<const StrainSampling> sample_assumed();

/// The sections of a beam, measures along e₁ and e₂: e₂ across the section of the reference and e₁
/// at right angles to it. At points over the sections, or with all their area on the axis.
std::shared_ptr<const StrainSampling> sample_sections(BeamStrains strains, bool on_axis);

}  // namespace flexmorph::fem
