#pragma once

#include <string>

#include "cases/results/run_result.h"

namespace flexmorph::cases {

/// What the last line of a run with designs says of them: mass, gain over uniform material of the
/// same mass with the measure it is taken by, verdicts, seconds. Of a run without designs: seconds.
std::string summary_words(const RunResult& result);

}  // namespace flexmorph::cases
