#pragma once

#include "cases/assembly/prepared_case.h"
#include "cases/results/run_result.h"

/// `[expect]` of a case and what its run found.
namespace flexmorph::cases {

/// Compares the expectations of a case with a result, in the order of their names.
std::vector<Expected> compare_expectations(const Scene& scene, const RunResult& result);

/// @throws Error (input), with place and the names that exist, for an expectation of a number that
///         no run of the scene has
void check_expectations(const PreparedCase& prepared);

}  // namespace flexmorph::cases
