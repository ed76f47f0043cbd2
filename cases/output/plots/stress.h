#pragma once

#include <string>

#include "cases/results/verified_outline.h"

namespace flexmorph::cases {

/// Draws a verified design under its worst load as SVG: displaced, in the colours of the von Mises
/// stress. Empty where there is no verification, or an infinite compliance.
std::string stress_plot(const VerifiedOutline& outline);

}  // namespace flexmorph::cases
