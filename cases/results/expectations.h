#pragma once

#include "cases/assembly/prepared_case.h"
#include "cases/results/run_result.h"

/// Comparison of the [expect] table of a case with the results of its run.
namespace flexmorph::cases {

/// Compares the expectations of a case with a result, and returns them in the order of their names.
std::vector<Expected> compare_expectations(const Scene& scene, const RunResult& result);

/// Verifies that a run of the case computes every number that [expect] names.
/// @throws Error (input), with location and the existing names, for an expectation of a number that
///         no run of the scene computes
void check_expectations(const PreparedCase& prepared);

}  // namespace flexmorph::cases
