#pragma once

#include <memory>
#include <vector>

#include "fem/section.h"
#include "fem/terms/density_term.h"
#include "fem/terms/membrane_invariant.h"

/// Membrane forces of thin plates, with strains of the displacement field or assumed strains.
namespace flexmorph::fem {

/// Returns the densities of the term and the points where they are sampled.
std::vector<ElasticPart> membrane_parts(const PlaneSection& section, Strains strains);

/// Returns the term in Gram form (membrane.cpp).
std::unique_ptr<Term> make_membrane(const PlaneSection& section, Strains strains);

}  // namespace flexmorph::fem
