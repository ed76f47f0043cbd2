#pragma once

#include <span>
#include <string>

#include "cases/stability/stability.h"

/// Tables and the picture of stability.
namespace flexmorph::cases {

void write_stability_csv(std::span<const StabilityRow> rows, const std::string& path);
std::string stability_markdown(std::span<const StabilityRow> rows);
/// For the terminal: all rows, or how many of each verdict alone.
std::string stability_text(std::span<const StabilityRow> rows, bool all);
/// A map: parameters down, suite by suite, cases across, the verdict as colour, the energy defect
/// (else the Newton iterations) as text.
std::string stability_svg(std::span<const StabilityRow> rows);

}  // namespace flexmorph::cases
