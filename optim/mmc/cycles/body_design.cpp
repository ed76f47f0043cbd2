#include "optim/mmc/cycles/body_design.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "optim/mmc/cycles/stages.h"
#include "optim/search.h"

namespace flexmorph::mmc {
namespace {

/// Fraction of a required width that counts as reached, because outlines have a tolerance.
constexpr double kWidthTolerance = 0.99;

/// The limits on the cost of the stages of a cycle, in equal shares.
class StageBudgets {
 public:
  /// @param widths  true if the last stage has constraints on widths
  StageBudgets(const optim::Settings& settings, int n_stages, int n_shares, bool widths)
      : settings_(settings), n_stages_(n_stages), n_shares_(n_shares), widths_(widths) {}

  /// Returns the share of the next stage.
  /// @param stage  index among the stages from one start, from 0
  StageBudget of(int stage) {
    ++used_;
    const bool last = stage == n_stages_ - 1;
    const auto until = [&](int k) { return settings_.max_iterations * k / n_stages_; };
    const auto solves =
        static_cast<int>(static_cast<double>(settings_.max_evaluations) * used_ / n_shares_);
    return {until(stage + 1) - until(stage),
            settings_.max_evaluations > 0 ? std::max(1, solves) : 0,
            (n_shares_ - used_) * settings_.max_iterations / n_stages_, last && widths_,
            widths_ && !last ? until(n_stages_) - until(n_stages_ - 1) : 0};
  }

  /// Returns the first 60 % of a share, after which unloaded components are removed again.
  StageBudget begin_of(StageBudget share) const {
    constexpr double kBegin = 0.6;
    const double rest = 1 - kBegin;
    const int all = share.iterations;
    share.iterations = static_cast<int>(kBegin * all);
    share.later += all - share.iterations;
    if (share.solves > 0)
      share.solves = std::max(
          1, share.solves - static_cast<int>(rest * settings_.max_evaluations / n_shares_));
    return share;
  }

 private:
  const optim::Settings& settings_;
  int n_stages_, n_shares_, used_ = 0;
  bool widths_;
};

size_t most_bands(std::span<const Subproblem> parts) {
  size_t out = 0;
  for (const Subproblem& p : parts) out = std::max(out, p.problem.bands.size());
  return out;
}

/// Returns the start designs (n_starts x n_bodies); the present designs come first.
std::vector<std::vector<Design>> starts_of(std::span<const Subproblem> parts, int cycle) {
  size_t n = 1;
  for (const Subproblem& p : parts)
    if (cycle == 1) n = std::max(n, 1 + p.problem.further_starts.size());
  std::vector<std::vector<Design>> out(n);
  for (const Subproblem& p : parts) {
    const std::vector<Design>& further = p.problem.further_starts;
    for (size_t s = 0; s < n; ++s)
      out[s].push_back(s == 0 || further.empty() ? p.problem.design
                                                 : further[std::min(s, further.size()) - 1]);
  }
  return out;
}

/// A result and the number of the start that led to it, from 1.
struct FromStart {
  StageResult result;
  int start = 1;
};

/// Runs the stages 1 to 4 of design_bodies().
FromStart staged(StageRunner& run, int cycle) {
  const std::vector<Subproblem>& parts = run.parts();
  const bool wide = std::any_of(parts.begin(), parts.end(),
                                [](const Subproblem& p) { return p.problem.widths.any(); });
  const auto coarse = static_cast<int>(most_bands(parts)) - 1;
  const int n_stages = coarse + 1 + (wide ? 1 : 0);
  const std::vector<std::vector<Design>> starts = starts_of(parts, cycle);
  const int n_shares =
      static_cast<int>(starts.size()) * (n_stages - (wide ? 1 : 0)) + (wide ? 1 : 0);
  StageBudgets shares(run.settings().optimizer, n_stages, n_shares, wide);
  std::optional<FromStart> best;
  for (size_t s = 0; s < starts.size() && run.is_running(); ++s) {
    StageResult now = first_designs(parts);
    now.designs = starts[s];
    for (int band = 0; band < coarse; ++band) {
      const StageBudget share = shares.of(band);
      if (cycle == 1) now = at_band(run, now, static_cast<size_t>(band), share);
    }
    const StageBudget share = shares.of(coarse);
    now = wide ? with_erosion(run, now, share) : last_stage(run, now, share);
    // A stopped run is incomplete; its result must not replace a complete one.
    if (!best || (run.is_running() &&
                  is_better(now.result, best->result.result, run.settings().optimizer.feasibility)))
      best = {std::move(now), static_cast<int>(s) + 1};
  }
  StageResult& now = best->result;
  if (wide && run.is_running()) {
    now = without_unloaded_components(run, now, false);
    const StageBudget share = shares.of(n_stages - 1), begin = shares.begin_of(share);
    now = last_stage(run, now, begin);
    // The constraints on widths cut some bars off. Their dangling ends are removed, and the
    // optimizer uses the material elsewhere.
    now = without_unloaded_components(run, now, false);
    now = last_stage(run, now, {share.iterations - begin.iterations, share.solves, 0, true});
    now = without_unloaded_components(run, now, true);
  }
  return *best;
}

/// Returns the designs as they are, without optimization.
StageResult evaluated(const std::vector<Subproblem>& parts) {
  StageResult out = first_designs(parts);
  for (size_t k = 0; k < parts.size(); ++k)
    out.formulations[k] = last_formulation(parts[k].problem);
  out.result.verdict.kind = optim::Verdict::Kind::evaluated;
  // An outline in place of components has no variables, therefore no KKT residual.
  if (std::any_of(parts.begin(), parts.end(), [](const Subproblem& p) { return p.problem.part; }))
    return out;
  CombinedProblem whole(parts, out.designs, out.formulations);
  optim::Problem& problem = whole.problem();
  const VectorXd x = problem.start();
  // A crisp volume meets its limit only to a thousandth; with this tolerance the limit is active.
  constexpr double kActive = 1e-3;
  out.result.kkt = out.result.verdict.kkt =
      optim::kkt_residual(problem.evaluate(x), x, problem.lower(), problem.upper(), kActive);
  return out;
}

std::string stop_text(const StageRunner& run, const optim::Result& result) {
  if (!run.is_running())
    return "interrupted after " + std::to_string(run.iterations()) + " iterations";
  if (result.verdict.kind == optim::Verdict::Kind::evaluated)
    return "evaluated: the design was not optimized";
  if (result.stop == optim::Stop::iteration_limit)
    return "iteration limit: " + std::to_string(run.iterations()) + " iterations; KKT residual " +
           optim::scientific(result.kkt);
  // A search whose objective hardly changes ends, although the design may not be converged.
  const bool at_rest = result.stop == optim::Stop::converged &&
                       result.verdict.kind != optim::Verdict::Kind::converged;
  return (at_rest ? "small change" : optim::to_string(result.stop)) +
         (result.message.empty() ? "" : ": " + result.message);
}

}  // namespace

bool BodyOutcome::reaches_length_scale() const {
  if (!length_scale) return true;
  const MinimumWidths& wanted = length_scale->wanted;
  return crisp.connectivity.islands == 0 && crisp.features &&
         crisp.features->solid >= kWidthTolerance * wanted.solid &&
         crisp.features->gap >= kWidthTolerance * wanted.gap;
}

BodyOutcome outcome_of(const Subproblem& p, const Design& design, const Formulation& formulation,
                       bool condition) {
  BodyOutcome out;
  out.body = p.problem.body;
  out.symmetry = design.symmetry();
  MmcProblem state({p.plate, design, p.ersatz, p.loads}, formulation.tdf, p.problem.goal);
  state.evaluate(state.start());
  // If no row of the goal needs the compliance, it has not been computed yet.
  out.compliance = std::isfinite(state.compliance())
                       ? state.compliance()
                       : design_compliance(p.problem, p.loads, state.factors());
  out.volume = state.volume();
  for (const ResponseRow* row : further_rows(p.problem.goal))
    out.further[key_of(*row)] = state.values(*row)->maxCoeff();
  out.crisp = crisp_design(p.problem, design.components(), p.loads);
  out.of_part = p.problem.part.has_value();
  if (out.of_part) {  // an outline has no regularized values
    out.compliance = out.crisp.compliance;
    out.volume = out.crisp.volume;
    out.further = out.crisp.further;
  }
  const CellScaleFactors crisp = p.ersatz.crisp(out.crisp.fractions);
  const VectorXd each = p.loads.individual(crisp.stiffness, crisp.mass);
  out.load_compliances.clear();
  for (int l = 0; l < p.loads.n_loads(); ++l)  // in the order in which the loads were given
    out.load_compliances.push_back(each[p.loads.position(l)]);
  out.worst_compliance = each.maxCoeff();
  if (condition) out.condition = p.loads.condition();
  // The comparison of the paper: uniform material with the allowed volume (or the crisp volume if
  // none is prescribed).
  const double volume = allowed_volume(p.problem.goal).value_or(out.crisp.volume);
  const VectorXd even = VectorXd::Constant(p.problem.grid.n_cells(), volume);
  out.uniform_compliance = design_compliance(p.problem, p.loads, {even, even});
  out.full = full_values(p.problem, p.loads);
  out.n_loads = p.loads.n_loads();
  out.n_right_hand_sides = p.loads.n_right_hand_sides();
  out.factorizations = p.loads.factorizations();
  if (p.problem.widths.any()) out.length_scale = {.wanted = p.problem.widths};
  return out;
}

std::vector<BodyOutcome> design_bodies(std::span<const LoadedBody> bodies, int cycle,
                                       const DesignSettings& settings,
                                       const IterationObserver& observe, bool& is_running) {
  StageRunner run(bodies, cycle, settings, observe);
  const FromStart last = settings.optimizer.max_iterations == 0 ? FromStart{evaluated(run.parts())}
                                                                : staged(run, cycle);
  const StageResult& now = last.result;
  std::vector<BodyOutcome> out;
  for (size_t k = 0; k < bodies.size(); ++k) {
    bodies[k].problem.design = now.designs[k];
    BodyOutcome& o = out.emplace_back(
        outcome_of(run.parts()[k], now.designs[k], now.formulations[k], settings.condition));
    o.start = last.start;
    o.kkt = now.result.kkt;
    o.change = now.changes[k];
    o.verdict = now.result.verdict;
    if (!run.is_running()) o.verdict.kind = optim::Verdict::Kind::unfinished;
    o.stop = stop_text(run, now.result);
    o.iterations = run.iterations();
    o.evaluations = run.evaluations();
    if (o.length_scale) {
      o.length_scale->removed = now.removed[k].components;
      o.length_scale->seconds = now.removed[k].seconds;
    }
  }
  is_running = run.is_running();
  return out;
}

BodyOutcome design_body(BodyProblem& problem, ComplianceEvaluator& loads, int cycle,
                        const DesignSettings& settings, const IterationObserver& observe,
                        bool& is_running) {
  const LoadedBody body{problem, loads};
  return design_bodies({&body, 1}, cycle, settings, observe, is_running).front();
}

}  // namespace flexmorph::mmc
