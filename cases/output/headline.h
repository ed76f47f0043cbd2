#pragma once

#include "cases/output/page/page.h"
#include "cases/output/run_folder.h"
#include "cases/results/run_result.h"

/// The numbers at the top of the page of a run.
namespace flexmorph::cases {

/// Returns the name of a load of a designed body: "load 3, t = 0.7 s"; of a static plate the name
/// of its load case.
/// @param load  index of the load
std::string load_name(const RunResult& result, const RunFolder& folder, const std::string& body,
                      size_t load);

/// Returns the numbers at the top of the page of a run: verdict, mass, gain, largest displacement
/// and stress, time; of a run without designs the numbers of its motion or path.
std::vector<PageFact> headline(const Scene& scene, const RunResult& result,
                               const RunFolder& folder);

}  // namespace flexmorph::cases
