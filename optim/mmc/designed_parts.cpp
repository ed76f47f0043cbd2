#include "optim/mmc/designed_parts.h"

#include <cmath>

namespace flexmorph::mmc {

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
