#pragma once

#include <string>
#include <vector>

#include "cases/assembly/prepared_case.h"

/// Names of the numbers that a run of a scene computes. Expectations and accuracy studies refer to
/// numbers by these names.
namespace flexmorph::cases {

/// A subproblem of a case whose numbers are measured: its motion (or path of equilibria) with full
/// material, or its designs at their start.
enum class Part { motion, design };
/// Returns the name of a subproblem: "motion" or "design".
std::string to_string(Part part);

/// Returns the subproblems that a scene has.
std::vector<Part> parts_of(const Scene& scene);

/// Returns the names of the quantities of a scene in a subproblem: columns of motion.csv or
/// path.csv, or results of designs. Numbers of run.json ("motion.energy_error") are not listed.
std::vector<std::string> candidates(const PreparedCase& prepared, Part part);

/// Returns the names of all quantities of a scene as a list for messages, separated by commas.
std::string all_candidates(const PreparedCase& prepared);

}  // namespace flexmorph::cases
