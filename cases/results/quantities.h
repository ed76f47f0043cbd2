#pragma once

#include <string>
#include <vector>

#include "cases/assembly/prepared_case.h"

/// Numbers that a run of a scene comes to, by name: what expectations and accuracy may ask for.
namespace flexmorph::cases {

/// What a case is measured in: its motion (or path of equilibria) with full material, and its
/// designs as they start.
enum class Part { motion, design };
std::string to_string(Part part);

/// Parts that a scene has.
std::vector<Part> parts_of(const Scene& scene);

/// Names of quantities that a scene offers: columns of motion.csv or path.csv, and figures of
/// designs. Numbers of run.json ("motion.energy_defect") come on top of them.
std::vector<std::string> candidates(const PreparedCase& prepared, Part part);

/// "there are: ..." for messages.
std::string all_candidates(const PreparedCase& prepared);

}  // namespace flexmorph::cases
