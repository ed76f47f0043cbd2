#pragma once

#include "cases/output/run_folder.h"
#include "cases/results/run_result.h"

namespace flexmorph::cases {

/// Writes run.json, the plots and report.html into the run folder.
/// @throws Error (numerical) when a file cannot be written
void write_report(const Scene& scene, const RunResult& result, RunFolder& folder);

/// Writes report.html of a run that goes on, which refreshes itself. No pictures are written to
/// plots/.
/// @param result  status, message and wall time so far
/// @throws Error (numerical) when the file cannot be written
void write_live_report(const Scene& scene, const RunResult& result, RunFolder& folder);

}  // namespace flexmorph::cases
