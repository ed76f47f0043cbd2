#pragma once

#include "cases/output/page/page.h"
#include "cases/output/run_folder.h"
#include "cases/results/run_result.h"

/// Sections of the page of a run that are tables. A section without contents has no HTML.
namespace flexmorph::cases {

/// Returns the numbers of the designs and of their verified outlines, from the result schema.
PageSection results_section(const Scene& scene, const DesignResult& design);
/// Returns the comparison of given parts with the design and with uniform material.
PageSection comparison_section(const RunResult& result);
/// Returns the table of all equivalent static loads, or of the load cases of a static plate.
PageSection loads_section(const RunResult& result, const RunFolder& folder);
/// Returns the comparison of the cycles, which shows whether the motion itself improved and not
/// only the compliance under the equivalent static loads.
PageSection cycles_section(const Scene& scene, const DesignResult& design);
/// Returns the corrected cycles, with the designs before and after them.
PageSection corrections_section(const DesignResult& design, const RunFolder& folder);
/// Returns the optimality certificate with its drawings.
PageSection certificate_section(const DesignResult& design, const RunFolder& folder);
/// Returns the numbers of the motion or of the path of equilibria, from the result schema.
PageSection motion_section(const RunResult& result);
/// Returns the heated bodies.
PageSection heat_section(const Scene& scene);
/// Returns the expected results; expectations that are not met come first.
PageSection expect_section(const Scene& scene, const RunResult& result);
/// Returns versions, machine, threads, times by phase and memory.
PageSection run_section(const RunResult& result);
/// Returns links to all files of the run with what they contain.
PageSection files_section(RunFolder& folder);
/// Returns the settings of the case that differ from their defaults.
PageSection settings_section(const Scene& scene);
/// Returns the case file.
PageSection case_section(const RunFolder& folder);

}  // namespace flexmorph::cases
