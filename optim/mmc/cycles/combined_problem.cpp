#include "optim/mmc/cycles/combined_problem.h"

#include <algorithm>
#include <utility>

namespace flexmorph::mmc {

Formulation nominal(const BodyProblem& problem, size_t band) {
  Formulation out{problem.bands.at(band)};
  out.tdf.erosion = 0;
  return out;
}

Formulation eroded(const BodyProblem& problem) {
  Formulation out{problem.bands.back()};
  out.tdf.erosion = problem.erosion;
  return out;
}

Formulation last_formulation(const BodyProblem& problem) {
  if (!problem.widths.any()) return eroded(problem);
  Formulation out = nominal(problem, problem.bands.size() - 1);
  out.outline = problem.widths;
  return out;
}

std::vector<Design> designs_of(std::span<const Subproblem> parts) {
  std::vector<Design> out;
  for (const Subproblem& p : parts) out.push_back(p.problem.design);
  return out;
}

bool limits_state(const BodyProblem& problem) {
  const std::vector<Limit>& limits = problem.goal.limits;
  return std::any_of(limits.begin(), limits.end(), [](const Limit& limit) {
    return limit.row->needs_state() && !limit.row->of_motion;
  });
}

CombinedProblem::CombinedProblem(std::span<const Subproblem> parts, std::vector<Design> designs,
                                 std::span<const Formulation> formulations,
                                 const std::vector<Goal>& goals, MotionState* motion)
    : designs_(std::move(designs)),
      outlines_(parts.size()),
      crisp_(parts.size()),
      limited_(parts.size()) {
  states.reserve(parts.size());
  couplings_.reserve(parts.size());
  for (size_t k = 0; k < parts.size(); ++k) {
    const Subproblem& p = parts[k];
    const Formulation& f = formulations[k];
    couplings_.push_back({motion, k});
    if (f.outline) outlines_[k].emplace(p.problem, *f.outline);
    if (f.crisp) crisp_[k].emplace(p.problem);
    if (limits_state(p.problem) && f.tdf.kind != TdfSettings::Kind::paper)
      limited_[k].emplace(p.problem);
    const auto picture = [](const std::optional<CrispPicture>& p) { return p ? &*p : nullptr; };
    states.push_back({{.plate = p.plate,
                       .design = designs_[k],
                       .ersatz = p.ersatz,
                       .loads = p.loads,
                       .shape = outlines_[k] ? &*outlines_[k] : nullptr,
                       .motion = motion ? &couplings_.back() : nullptr,
                       .crisp = picture(crisp_[k]),
                       .limited = picture(limited_[k])},
                      f.tdf,
                      goals[k],
                      p.problem.locations});
  }
  if (parts.size() == 1) return;
  std::vector<SharedProblem::Part> all;
  for (size_t k = 0; k < parts.size(); ++k)
    all.push_back({&states[k], parts[k].plate.full_mass(), parts[k].problem.shares_mass});
  shared_.emplace(std::move(all));
}

std::vector<Goal> CombinedProblem::goals_of_loads(std::span<const Subproblem> parts) {
  std::vector<Goal> out;
  for (const Subproblem& p : parts) out.push_back(p.problem.goal);
  return out;
}

namespace {

std::vector<Goal> goals_of_motion(std::span<const Subproblem> parts) {
  std::vector<Goal> out;
  for (const Subproblem& p : parts) out.push_back(p.problem.motion_goal);
  return out;
}

}  // namespace

CombinedProblem::CombinedProblem(std::span<const Subproblem> parts, std::vector<Design> designs,
                                 std::span<const Formulation> formulations, MotionState& motion)
    : CombinedProblem(parts, std::move(designs), formulations, goals_of_motion(parts), &motion) {}

CombinedProblem CombinedProblem::smooth(std::span<const Subproblem> parts,
                                        std::vector<Design> designs,
                                        std::span<const Formulation> formulations) {
  std::vector<Goal> goals = goals_of_loads(parts);
  for (Goal& goal : goals) goal = mmc::smooth(std::move(goal));
  return {parts, std::move(designs), formulations, goals, nullptr};
}

std::vector<Design> CombinedProblem::designs_at(const VectorXd& x) const {
  std::vector<Design> out = designs_;
  for (size_t k = 0; k < out.size(); ++k) out[k].move_to(states[k].design_part(part_of(x, k)));
  return out;
}

}  // namespace flexmorph::mmc
