#pragma once

#include <string>

#include "cases/results/run_result.h"
#include "cases/scene/scene.h"

namespace flexmorph::cases {

/// Writes a result as the text of run.json (cases/README.md, The run folder).
std::string run_json(const Scene& scene, const RunResult& result);
/// Writes a certificate as the text that stands in run.json under "certificate".
std::string certificate_json(const mmc::MotionCertificate& certificate);

}  // namespace flexmorph::cases
