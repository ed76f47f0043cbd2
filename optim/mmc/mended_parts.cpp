#include "optim/mmc/mended_parts.h"

#include <algorithm>

#include "optim/mmc/renewed_parts.h"
#include "optim/mmc/usability.h"

namespace flexmorph::mmc {

Mended repaired(std::vector<Part>& parts, double gaps, bool trims,
                const std::function<bool()>& go_on) {
  std::vector<double> volumes;
  double used = 0, allowed = 0;
  for (const Part& p : parts) {
    volumes.push_back(fractions_of(p.problem, p.problem.design.components()).sum() /
                      p.ersatz.n_domain_cells());
    if (!p.problem.shares_mass) continue;
    used += p.plate.full_mass() * volumes.back();
    allowed += p.plate.full_mass() * allowed_volume(p.problem.goal).value_or(1);
  }
  Mended out;
  for (size_t k = 0; k < parts.size(); ++k) {
    Part& p = parts[k];
    std::optional<CleanUp>& done = out.clean_ups.emplace_back();
    if (p.problem.widths.any()) {
      RepairWishes wishes{.trims = trims, .go_on = go_on};
      if (p.problem.shares_mass && used > 0)
        wishes.max_volume = std::min(1.0, volumes[k] * allowed / used);
      Widths wanted = p.problem.widths;
      wanted.gap *= gaps;
      done = clean_up(p.problem, p.loads, wanted, wishes);
      done->wanted = p.problem.widths;
      out.reached = out.reached && done->reached();
      out.changed = out.changed || done->changed();
    }
    const SharpDesign crisp = crisp_figures(p);
    out.objective += crisp_value(*p.problem.goal.objective, p.problem.goal, crisp);
    out.violation = std::max(out.violation, crisp_violation(p.problem, crisp));
    out.designs.push_back(p.problem.design);
  }
  return out;
}

std::vector<CleanUp> renewed(std::vector<Part>& parts, const std::function<bool()>& go_on) {
  std::vector<CleanUp> out(parts.size());
  for (size_t k = 0; k < parts.size(); ++k) {
    BodyProblem& problem = parts[k].problem;
    if (!problem.widths.any()) continue;
    UnderRepair design(problem, parts[k].loads, problem.widths, go_on);
    out[k].born = bear_parts(design);
    out[k].joined = join_parts(design);
    if (out[k].born + out[k].joined > 0) problem.design = problem.design.with(design.parts);
  }
  return out;
}

Mended looked_over(std::vector<Part>& parts) {
  Mended out = as_they_are(parts);
  for (size_t k = 0; k < parts.size(); ++k) {
    Part& p = parts[k];
    if (!p.problem.widths.any()) continue;
    out.clean_ups[k] = look_over(p.problem, p.loads, p.problem.widths);
    out.reached = out.reached && out.clean_ups[k]->reached();
    out.changed = out.changed || out.clean_ups[k]->changed();
  }
  return out;
}

Mended as_they_are(const std::vector<Part>& parts) {
  Mended out;
  for (const Part& p : parts) {
    out.clean_ups.push_back(p.outcome.clean_up);
    out.designs.push_back(p.problem.design);
  }
  return out;
}

}  // namespace flexmorph::mmc
