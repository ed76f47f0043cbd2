#pragma once

#include <string>

#include "cases/results/judged.h"

namespace flexmorph::cases {

/// What a judged design does under its worst load: displaced, in the colours of the von Mises
/// stress. Empty where there is no verdict, or an infinite one.
std::string stress_plot(const JudgedBody& judged);

/// Von Mises stress at the nodes of the judge's mesh (n) [Pa].
std::vector<double> mises_of(const verification::OutlineVerification& judged);

}  // namespace flexmorph::cases
