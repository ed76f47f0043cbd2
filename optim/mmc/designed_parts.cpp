#include "optim/mmc/designed_parts.h"

#include <cmath>

#include "optim/mmc/united_connectivity.h"

namespace flexmorph::mmc {
namespace {

/// The sharp design by its cells, without the widths of its outlines, which cost more than an
/// analysis does. What hangs together shows in the outlines here, too.
SharpDesign without_outlines(const Part& p) {
  SharpDesign out;
  out.fractions = fractions_of(p.problem, p.problem.design.components());
  out.volume = out.fractions.sum() / p.ersatz.n_domain_cells();
  const CellFactors sharp = p.ersatz.sharp(out.fractions);
  const std::vector<Component> components = p.problem.design.components();
  out.compliance = design_compliance(p.problem, p.loads, sharp);
  out.further = further_values(p.problem, components, p.loads, sharp);
  out.connectivity = united_connectivity(p.problem, components, out.fractions);
  return out;
}

}  // namespace

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

void finish_outcome(Part& p, bool analysed, bool condition) {
  BodyOutcome& out = p.outcome;
  out.sharp = analysed ? without_outlines(p)
                       : sharp_design(p.problem, p.problem.design.components(), p.loads);
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
