#include "optim/mmc/problem/goal.h"

#include <algorithm>

namespace flexmorph::mmc {

std::vector<const ResponseRow*> rows_of(const Goal& goal) {
  std::vector<const ResponseRow*> out = {goal.objective};
  for (const Limit& limit : goal.limits)
    if (std::find(out.begin(), out.end(), limit.row) == out.end()) out.push_back(limit.row);
  return out;
}

const ResponseRow& compliance_row(const Goal& goal) {
  for (const ResponseRow* row : rows_of(goal))
    if (row->needs_state()) return *row;
  return kComplianceSum;
}

std::vector<const ResponseRow*> further_rows(const Goal& goal) {
  std::vector<const ResponseRow*> out = rows_of(goal);
  std::erase_if(
      out, [&](const ResponseRow* row) { return row == &kVolume || row == &compliance_row(goal); });
  return out;
}

std::optional<double> allowed_volume(const Goal& goal) {
  std::optional<double> least;
  for (const Limit& limit : goal.limits)
    if (limit.volume && !limit.at_least) least = std::min(*limit.volume, least.value_or(1e300));
  return least;
}

bool is_held_back(const Goal& goal) {
  // More material reduces compliances and responses of the motion, and increases all other
  // responses.
  const bool wants_more = goal.objective->falls_with_material();
  return std::any_of(goal.limits.begin(), goal.limits.end(), [&](const Limit& limit) {
    return wants_more == (limit.row->falls_with_material() == limit.at_least);
  });
}

bool asks_state(const Goal& goal) {
  const auto rows = rows_of(goal);
  return std::any_of(rows.begin(), rows.end(),
                     [](const ResponseRow* r) { return r->needs_state(); });
}

bool has_motion(const Goal& goal) {
  const auto rows = rows_of(goal);
  return std::any_of(rows.begin(), rows.end(), [](const ResponseRow* r) { return r->of_motion; });
}

Goal goal_of_loads(Goal goal) {
  if (goal.objective->of_motion)
    goal.objective = goal.objective == &kPeakStrainEnergy ? &kComplianceWorst : &kComplianceSum;
  goal.addends.clear();
  std::erase_if(goal.limits, [](const Limit& limit) { return limit.row->of_motion; });
  return goal;
}

Goal goal_of_motion(Goal goal) {
  if (goal.objective->needs_state())
    goal.objective = goal.objective->per_load ? &kPeakStrainEnergy : &kStrainEnergy;
  std::erase_if(goal.limits, [](const Limit& limit) { return limit.row->needs_state(); });
  return goal;
}

Goal smooth(Goal goal) {
  if (goal.objective == &kComplianceWorst) goal.objective = &kCompliancePeak;
  return goal;
}

std::string objective_text(const Goal& goal) {
  std::string out(goal.addends.empty() ? "" : "weighted sum of ");
  out += goal.objective->words;
  for (const Addend& a : goal.addends) out.append(", ").append(a.row->words);
  return out;
}

}  // namespace flexmorph::mmc
