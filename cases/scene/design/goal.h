#pragma once

#include <string>
#include <vector>

#include "io/case_files/case_file.h"
#include "optim/mmc/problem/goal.h"

/// The objective and the limits of a [[design]]: `minimize`, `loads`, `max_volume`,
/// `max_compliance`, [[design.objective]], [[design.constraint]].
namespace flexmorph::cases {

struct Scene;

/// Reads the objective and the limits of a design.
/// @param t      the [[design]]
/// @param plate  the plate that is designed; limits are compared with its values when it is full
/// @throws Error (input) located in the file, see io::Table.
mmc::Goal read_goal(const io::Table& t, const mmc::Plate& plate);

/// Checks that a design can share its budget of mass with others: it minimizes the weighted sum of
/// compliances under a limit that can be shared.
/// @throws Error (input) located in the file
void check_sharing(const io::Table& t, const mmc::Goal& goal);

/// Returns the limits of a goal as text: "volume at most 0.5, mass at least 2 kg".
std::string limit_text(const mmc::Goal& goal);
/// Returns a goal as text: "summed compliance under a volume of 0.4".
std::string goal_text(const mmc::Goal& goal);

/// Returns the responses of all designs for which the tables need additional columns, each once.
std::vector<const mmc::ResponseRow*> further_rows(const Scene& scene);

}  // namespace flexmorph::cases
