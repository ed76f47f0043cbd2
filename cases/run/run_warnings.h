#pragma once

#include <string>
#include <vector>

#include "cases/run/report.h"

namespace flexmorph::cases {

/// What a run has to say against its own results, a sentence each: designs in pieces, bridged gaps,
/// limits that are not kept; nearly singular joints, energy that is missed.
std::vector<std::string> warnings_of(const Scene& scene, const RunReport& report);

}  // namespace flexmorph::cases
