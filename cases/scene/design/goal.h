#pragma once

#include <string>
#include <vector>

#include "io/case_files/case_file.h"
#include "optim/mmc/problem/goal.h"

/// What a [[design]] is to be good at: `minimize`, `loads`, `max_volume`, `max_compliance`,
/// [[design.constraint]].
namespace flexmorph::cases {

struct Scene;

/// @param t  the [[design]]
/// @throws Error (input) located in the file, see io::Table.
mmc::Goal read_goal(const io::Table& t, const mmc::Plate& plate);

/// What bodies that share their mass have in common. @throws Error (input) located in the file.
void check_sharing(const io::Table& t, const mmc::Goal& goal);

/// "volume at most 0.5, mass at least 2 kg"
std::string limit_words(const mmc::Goal& goal);
/// "summed compliance under a volume of 0.4"
std::string goal_words(const mmc::Goal& goal);

/// Responses of all designs that have no column of their own in tables: each once.
std::vector<const mmc::ResponseRow*> further_rows(const Scene& scene);

}  // namespace flexmorph::cases
