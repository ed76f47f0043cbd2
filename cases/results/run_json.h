#pragma once

#include <string>

#include "cases/output/report.h"

namespace flexmorph::cases {

/// The text of run.json: what the run found, in numbers (cases/README.md, The run folder).
std::string run_json(const Scene& scene, const RunReport& report);
/// What stands in it under "certificate".
std::string certificate_json(const mmc::MotionCertificate& certificate);

}  // namespace flexmorph::cases
