#pragma once

#include <string>

#include "cases/results/run_result.h"

namespace flexmorph::cases {

/// Returns the summary for the last line of a run. With designs it contains the mass, the gain over
/// uniform material of the same mass with its measure, the verdicts, and the wall time. Without
/// designs it contains the wall time only.
std::string summary_text(const RunResult& result);

}  // namespace flexmorph::cases
