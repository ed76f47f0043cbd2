#include "optim/mmc/cycles/usability.h"

#include <algorithm>
#include <limits>

namespace flexmorph::mmc {

double crisp_value(const ResponseRow& row, const Goal& goal, const CrispDesign& crisp) {
  if (&row == &kVolume) return crisp.volume;
  if (&row == &compliance_row(goal)) return crisp.compliance;
  return crisp.further.at(key_of(row));
}

bool binds_body(const Limit& limit, const BodyProblem& problem) {
  return !(problem.shares_mass && limit.volume && !limit.at_least);
}

double crisp_violation(const BodyProblem& problem, const CrispDesign& crisp) {
  if (!crisp.connectivity.loose_loads.empty()) return std::numeric_limits<double>::infinity();
  double out = 0;
  for (const Limit& limit : problem.goal.limits)
    if (binds_body(limit, problem) && !limit.row->of_motion)
      out = std::max(out, limit.excess(crisp_value(*limit.row, problem.goal, crisp)));
  return out > kLimitTolerance ? out : 0;
}

bool worse_than_uniform(const BodyProblem& problem, const BodyOutcome& outcome) {
  return problem.goal.objective == &compliance_row(problem.goal) &&
         outcome.crisp.compliance > outcome.uniform_compliance;
}

}  // namespace flexmorph::mmc
