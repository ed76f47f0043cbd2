#include "optim/mmc/cycles/stages.h"

#include <algorithm>
#include <cassert>
#include <optional>
#include <utility>

#include "geometry/cpu_time.h"
#include "optim/cancellable_problem.h"
#include "optim/mmc/length_scale/unloaded_components.h"

namespace flexmorph::mmc {
namespace {

/// Reduces the first steps. The optimizer satisfies new constraints first, whatever happens to the
/// objective: with full steps a design breaks where it violates the minimum length scale before the
/// widths have grown.
void begin_gently(optim::Settings& settings) {
  constexpr double kMove = 0.4, kAsymptotes = 0.01;
  settings.move_limit *= kMove;
  if (settings.name == "mma" || settings.name == "gcmma")
    settings.options.try_emplace("asyinit", kAsymptotes);
}

/// Counts the factorizations of all bodies.
class LoadsWork final : public optim::WorkCounter {
 public:
  explicit LoadsWork(std::span<const Subproblem> parts) : parts_(parts) {}
  optim::Work work() const override {
    optim::Work out;
    for (const Subproblem& p : parts_) {
      const ComplianceEvaluator::Work own = p.loads.work();
      out.insert(out.end(), {own.factorizations, own.factored});
    }
    return out;
  }
  void continue_from(const optim::Work& work) override {
    if (work.size() != 2 * parts_.size()) return;
    for (size_t k = 0; k < parts_.size(); ++k)
      parts_[k].loads.continue_from({work[2 * k], work[2 * k + 1]});
  }

 private:
  std::span<const Subproblem> parts_;
};

StageBudget with_gentle(StageBudget share, bool gentle) {
  share.gentle = gentle;
  return share;
}

}  // namespace

StageRunner::StageRunner(std::span<const LoadedBody> bodies, int cycle,
                         const DesignSettings& settings, const IterationObserver& observe)
    : parts_(bodies.begin(), bodies.end()), cycle_(cycle), settings_(settings), observe_(observe) {}

StageResult StageRunner::optimize(const StageResult& from, std::vector<Formulation> formulations,
                                  const StageBudget& share) {
  if (share.iterations <= 0 || !is_running_ || (share.solves > 0 && evaluations_ >= share.solves))
    return from;
  most_left_ = share.iterations + share.later;
  in_widths_ = share.widths;
  most_left_with_widths_ = share.widths ? most_left_ : share.later_with_widths;
  optim::Settings settings = settings_.optimizer;
  settings.max_iterations = share.iterations;
  settings.plateau = settings.rest.rows > 0;
  if (share.gentle) begin_gently(settings);
  settings.max_evaluations = share.solves > 0 ? share.solves - evaluations_ : 0;
  CombinedProblem whole(parts_, from.designs, formulations);
  std::optional<optim::RecordedProblem> recorded;
  LoadsWork work(parts_);
  if (settings_.past) recorded.emplace(whole.problem(), settings_.past->log, &work);
  optim::CancellableProblem problem(recorded ? *recorded : whole.problem(),
                                    [this] { return is_running_ = keeps_running(); });
  StageResult out = from;
  out.formulations = std::move(formulations);
  out.result = optim::make_optimizer(settings)->minimize(
      problem, [&](const optim::Iterate& iterate) { return see(whole, iterate); });
  evaluations_ += out.result.evaluations;
  out.designs = whole.designs_at(out.result.x);
  out.changes.clear();
  for (size_t k = 0; k < parts_.size(); ++k)
    out.changes.push_back((out.designs[k].x() - from.designs[k].x()).lpNorm<Eigen::Infinity>());
  return out;
}

bool StageRunner::see(CombinedProblem& whole, const optim::Iterate& iterate) {
  ++iterations_;
  most_left_ = std::max(0, most_left_ - 1);
  if (in_widths_) {
    ++with_widths_;
    most_left_with_widths_ = most_left_;
  }
  bool known = true;  // all rows are those of the earlier run
  for (size_t k = 0; k < parts_.size(); ++k) {
    MmcProblem& state = whole.states[k];
    const VectorXd x = whole.part_of(*iterate.x, k);
    // The state belongs to a later trial, or the evaluation came from the log.
    if (state.x().size() != x.size() || state.x() != x) state.restore(x);
    if (!see(parts_[k], state, iterate, k == 0)) known = false;
  }
  if (settings_.past) {
    optim::EvaluationLog& log = settings_.past->log;
    LoadsWork work(parts_);
    if (known)
      work.continue_from(log.work_after());
    else
      log.append_work(work.work());
  }
  return is_running_;
}

bool StageRunner::see(const Subproblem& p, MmcProblem& state, const optim::Iterate& iterate,
                      bool first) {
  const Past* past = settings_.past;
  if (past && past->log.knew_last() && past->has_row({p.problem.body, cycle_, iterations_}))
    return true;
  if (!state.is_solved()) state.evaluate(VectorXd(state.x()));
  CrispDesign crisp;
  const bool wanted = settings_.crisp_every > 0 && iterations_ % settings_.crisp_every == 0;
  if (wanted) crisp = crisp_design(p.problem, state.components(), p.loads);
  optim::Iterate own = iterate;
  own.x = &state.x();
  if (!first) own.seconds = 0;
  if (observe_ && !observe_({p.problem, cycle_, iterations_, evaluations_ + iterate.evaluations,
                             with_widths_, most_left_, most_left_with_widths_, own, state,
                             state.value(), p.loads, wanted ? &crisp : nullptr}))
    is_running_ = false;
  state.clear_seconds();
  return false;
}

StageResult first_designs(std::span<const Subproblem> parts) {
  StageResult out;
  out.designs = designs_of(parts);
  for (const Subproblem& p : parts) out.formulations.push_back(eroded(p.problem));
  out.changes.assign(parts.size(), 0);
  out.removed.assign(parts.size(), {});
  return out;
}

StageResult at_band(StageRunner& run, const StageResult& from, size_t band,
                    const StageBudget& share) {
  size_t most = 0;
  for (const Subproblem& p : run.parts()) most = std::max(most, p.problem.bands.size());
  assert(most > 0);
  std::vector<Formulation> formulations;
  for (const Subproblem& p : run.parts())
    formulations.push_back(nominal(p.problem, band * p.problem.bands.size() / most));
  return run.optimize(from, std::move(formulations), share);
}

StageResult with_erosion(StageRunner& run, const StageResult& from, const StageBudget& share) {
  std::vector<Formulation> formulations;
  for (const Subproblem& p : run.parts()) formulations.push_back(eroded(p.problem));
  return run.optimize(from, std::move(formulations), with_gentle(share, true));
}

StageResult without_unloaded_components(StageRunner& run, const StageResult& from,
                                        bool keeps_width) {
  StageResult out = from;
  for (size_t k = 0; k < run.parts().size(); ++k) {
    const Subproblem& p = run.parts()[k];
    // A goal without responses of the loads does not tell which components are loaded.
    if (!p.problem.widths.any() || !asks_state(p.problem.goal) || !run.keeps_running()) continue;
    const double begin = cpu_seconds();
    const std::vector<int> removed = remove_unloaded_components(
        p.problem, p.loads, out.designs[k], keeps_width, [&] { return run.keeps_running(); });
    out.removed[k].components += static_cast<int>(removed.size());
    out.removed[k].seconds += cpu_seconds() - begin;
  }
  return out;
}

StageResult last_stage(StageRunner& run, const StageResult& from, const StageBudget& share) {
  std::vector<Formulation> formulations;
  for (const Subproblem& p : run.parts()) formulations.push_back(last_formulation(p.problem));
  const bool gentle = std::any_of(formulations.begin(), formulations.end(),
                                  [](const Formulation& f) { return f.outline.has_value(); });
  return run.optimize(from, std::move(formulations), with_gentle(share, gentle));
}

bool is_better(const optim::Result& a, const optim::Result& b, double feasibility) {
  const bool feasible_a = a.violation <= feasibility, feasible_b = b.violation <= feasibility;
  if (feasible_a != feasible_b) return feasible_a;
  return feasible_a ? optim::attained_objective(a.response) <= optim::attained_objective(b.response)
                    : a.violation <= b.violation;
}

}  // namespace flexmorph::mmc
