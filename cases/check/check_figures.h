#pragma once

#include <string>

#include "cases/assembly/build.h"
#include "cases/assembly/resource_estimate.h"

namespace flexmorph::cases {

/// A line of a summary: what, and words on it.
std::string summary_row(const std::string& what, const std::string& words);

/// The part of a summary that makes mistakes visible: lowest frequencies, deflections, turns, what
/// the run will take, and under a heading of its own what is out of the ordinary.
/// @param mechanism  of a scene that moves, else null
std::string figures_text(const Scene& scene, const Mechanism* mechanism, const Machine& machine);

}  // namespace flexmorph::cases
