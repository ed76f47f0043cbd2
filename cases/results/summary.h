#pragma once

#include <string>

#include "cases/results/run_result.h"

namespace flexmorph::cases {

/// Returns the summary for the last line of a run. With designs it contains the mass, the gain over
/// uniform material of the same mass with its measure, the verdicts, and the wall time. Without
/// designs it contains the wall time only.
std::string summary_text(const RunResult& result);

/// Returns the mass of the crisp designs of all bodies [kg]; 0 if they have no density.
double mass_of(const DesignResult& design);

/// A quantity of the designs, and its value for uniform material of equal mass.
struct Gain {
  std::string quantity;              ///< Name of the quantity.
  double designed = 0, uniform = 0;  ///< Values of the designs and of uniform material.
  const char* unit = "J";            ///< Unit of both values.

  /// Returns the change of the quantity by the designs [-]; negative: the designs are better.
  double change() const { return designed / uniform - 1; }
};
/// Returns the comparison of the designs with uniform material: by their motions, or under the
/// loads of a static plate. Nothing if there is no uniform material to compare with.
std::optional<Gain> gain_of(const RunResult& result);

}  // namespace flexmorph::cases
