#include "optim/mmc/designed_parts.h"

#include <algorithm>
#include <cmath>

#include "optim/mmc/usability.h"

namespace flexmorph::mmc {

bool limits_state(const Part& p) {
  const std::vector<Limit>& limits = p.problem.goal.limits;
  return std::any_of(limits.begin(), limits.end(), [](const Limit& limit) {
    return limit.row->needs_state() && !limit.row->of_motion;
  });
}

SharpDesign crisp_figures(const Part& p) {
  SharpDesign out;
  const std::vector<Component> components = p.problem.design.components();
  out.fractions = fractions_of(p.problem, components);
  out.volume = out.fractions.sum() / p.ersatz.n_domain_cells();
  const CellFactors sharp = p.ersatz.sharp(out.fractions);
  out.compliance = design_compliance(p.problem, p.loads, sharp);
  out.further = further_values(p.problem, components, p.loads, sharp);
  return out;
}

void follow_crisp(Part& p) {
  UnionTdf union_tdf(p.problem.grid, *p.tdf);
  const std::vector<Component> components = p.problem.design.components();
  union_tdf.evaluate(components);
  CellFactors factors;
  p.ersatz.factors(union_tdf.density(), union_tdf.eroded(), factors);
  p.crisp_ratios.clear();
  p.crisp_ratios[key_of(kVolume)] = fractions_of(p.problem, components).sum() / factors.mass.sum();
  if (!limits_state(p)) return;
  const SharpDesign crisp = crisp_figures(p);
  const Goal& goal = p.problem.goal;
  MmcProblem state = p.state();
  state.evaluate(state.start());
  for (const Limit& limit : goal.limits)
    if (limit.row->needs_state() && !limit.row->of_motion)
      p.crisp_ratios[key_of(*limit.row)] =
          crisp_value(*limit.row, goal, crisp) / state.values(*limit.row)->maxCoeff();
}

void measure(Part& p) {
  MmcProblem state = p.state();
  state.evaluate(state.start());
  // A goal without a compliance has never asked for one.
  p.outcome.compliance = std::isfinite(state.compliance())
                             ? state.compliance()
                             : design_compliance(p.problem, p.loads, state.factors());
  p.outcome.volume = state.volume();
  for (const ResponseRow* row : further_rows(p.problem.goal))
    p.outcome.further[key_of(*row)] = state.values(*row)->maxCoeff();
}

void finish_outcome(Part& p, bool condition) {
  BodyOutcome& out = p.outcome;
  out.sharp = sharp_design(p.problem, p.problem.design.components(), p.loads);
  const CellFactors sharp = p.ersatz.sharp(out.sharp.fractions);
  const VectorXd each = p.loads.individual(sharp.stiffness, sharp.mass);
  out.load_compliances.assign(each.data(), each.data() + each.size());
  out.worst_compliance = each.maxCoeff();
  if (condition) out.condition = p.loads.condition();
  // The paper's comparison: the volume that was allowed (or came out), spread evenly.
  const double volume = allowed_volume(p.problem.goal).value_or(out.sharp.volume);
  const VectorXd even = VectorXd::Constant(p.problem.grid.n_cells(), volume);
  out.uniform_compliance = design_compliance(p.problem, p.loads, {even, even});
  out.full = full_values(p.problem, p.loads);
  out.factorizations = p.loads.factorizations();
}

}  // namespace flexmorph::mmc
