#pragma once

#include <string>

#include "cases/results/run_result.h"
#include "cases/scene/scene.h"

namespace flexmorph::cases {

/// Returns a result as the text of run.json (cases/docs/output.md).
std::string run_json(const Scene& scene, const RunResult& result);
/// Returns a certificate as the text of the entry "certificate" of run.json.
std::string certificate_json(const mmc::OptimalityCertificate& certificate);

}  // namespace flexmorph::cases
