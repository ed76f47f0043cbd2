#pragma once

#include <string>

#include "cases/assembly/prepared_case.h"

namespace flexmorph::cases {

/// Returns the section of a summary with the lowest three natural frequencies of the mechanism at
/// start, middle and end of its motion, and the time step times the lowest one. For large models
/// the section names the command that computes them.
std::string natural_frequencies_text(const PreparedCase& prepared);

}  // namespace flexmorph::cases
