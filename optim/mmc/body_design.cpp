#include "optim/mmc/body_design.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace flexmorph::mmc {
namespace {

/// With a smallest feature, so many times a part of the iterations follows a clean-up.
constexpr int kPolishes = 2, kPolishShare = 6;

/// One cycle's design problem of one body.
class BodyDesigner {
 public:
  BodyDesigner(BodyProblem& problem, LoadResponse& loads, int cycle, const DesignSettings& settings,
               const IterationObserver& observe)
      : problem_(problem),
        loads_(loads),
        cycle_(cycle),
        settings_(settings),
        observe_(observe),
        ersatz_(ersatz_of(problem)) {}

  BodyOutcome go() {
    outcome_.body = problem_.body;
    outcome_.n_loads = loads_.n_loads();
    outcome_.n_right_hand_sides = loads_.n_right_hand_sides();
    // Stages share iterations and state solves evenly; polishes after a clean-up have their part.
    const int polishes = problem_.min_feature > 0 ? kPolishes : 0;
    const auto share = [&](int total) { return total - polishes * (total / kPolishShare); };
    const int iterations = share(settings_.optimizer.max_iterations);
    const int solves = share(settings_.optimizer.max_evaluations);
    const auto n_stages = static_cast<int>(problem_.stages.size());
    for (int stage = 0; stage < n_stages && going_; ++stage)
      run_stage(stage, iterations * (stage + 1) / n_stages - iterations * stage / n_stages,
                solves * (stage + 1) / n_stages);
    if (problem_.min_feature > 0 && going_) thicken();
    finish();
    outcome_.factorizations = loads_.factorizations();
    return std::move(outcome_);
  }
  bool stopped() const { return !going_; }  ///< by the observer

 private:
  /// A stage of the band: runs of the optimizer, a new one whenever the list of components changed.
  /// @param solves  state solves of the cycle after which it ends; 0: no limit
  void run_stage(int stage, int left, int solves) {
    const TdfSettings& tdf = problem_.stages[static_cast<size_t>(stage)];
    const double shortest = problem_.refill ? problem_.design.shortest() : 0;
    Turnover turnover(problem_.grid, tdf, ersatz_, shortest);
    turnover_ = &turnover;
    std::optional<Candidate> best;
    while (left > 0 && going_ && (solves == 0 || outcome_.evaluations < solves)) {
      MmcProblem state(problem_.grid, problem_.design, ersatz_, loads_, tdf, problem_.goal,
                       problem_.places);
      Candidate found = run(state, left, solves);
      left -= found.result.iterations;
      if (!best || better(found.result, best->result)) {
        best = std::move(found);
        best->newest = true;
      } else {
        best->newest = false;
      }
      if (!changed_) break;
      changed_ = false;
      problem_.design = problem_.design.with(turnover.next());
    }
    if (best) settle(*best, tdf);
  }

  /// The best design of one run of the optimizer.
  struct Candidate {
    Design design;
    optim::Result result;
    double change = 0;
    bool newest = true;  ///< does it belong to the last run?
  };

  Candidate run(MmcProblem& state, int iterations, int solves) {
    optim::Settings settings = settings_.optimizer;
    settings.max_iterations = iterations;
    settings.max_evaluations = solves > 0 ? solves - outcome_.evaluations : 0;
    const auto watch = [&](const optim::Iterate& iterate) { return see(state, iterate); };
    Candidate out{problem_.design, optim::make_optimizer(settings)->minimize(state, watch)};
    out.change = out.design.move_to(state.design_part(out.result.x));
    outcome_.evaluations += out.result.evaluations;
    return out;
  }

  bool better(const optim::Result& a, const optim::Result& b) const {
    const double tolerance = settings_.optimizer.feasibility;
    const bool feasible_a = a.violation <= tolerance, feasible_b = b.violation <= tolerance;
    if (feasible_a != feasible_b) return feasible_a;
    return feasible_a ? a.response.f <= b.response.f : a.violation <= b.violation;
  }

  /// Takes the best design of a stage.
  void settle(const Candidate& best, const TdfSettings& tdf) {
    problem_.design = best.design;
    if (!best.newest)
      outcome_.events.push_back({ComponentEvent::Kind::restored, 0, best.design.n_components()});
    outcome_.change = best.change;
    outcome_.kkt = best.result.kkt;
    outcome_.stop = optim::to_string(best.result.stop) +
                    (best.result.message.empty() ? "" : ": " + best.result.message);
    measure(tdf);
  }

  /// Blurred figures of the design.
  void measure(const TdfSettings& tdf) {
    MmcProblem state(problem_.grid, problem_.design, ersatz_, loads_, tdf, problem_.goal,
                     problem_.places);
    state.evaluate(state.start());
    outcome_.compliance = state.compliance();
    outcome_.volume = state.volume();
  }

  /// Makes the design as thick as wanted; then optimizes from there, and does it again: what was
  /// put over narrow places is shaped as well. The least compliant of the thick ones is kept.
  void thicken() {
    CleanUp best = clean_up(problem_, loads_, problem_.min_feature);
    CleanUp sum = best;
    Design kept = problem_.design;
    const auto last = static_cast<int>(problem_.stages.size()) - 1;
    const int budget = settings_.optimizer.max_evaluations;
    for (int round = 1; round <= kPolishes && going_; ++round) {
      run_stage(last, settings_.optimizer.max_iterations / kPolishShare,
                budget - (kPolishes - round) * (budget / kPolishShare));
      const CleanUp next = clean_up(problem_, loads_, problem_.min_feature);
      sum.rounds += next.rounds;
      sum.patches += next.patches;
      sum.dropped += next.dropped;
      const bool better = next.reached() == best.reached()
                              ? (best.reached() ? next.compliance_after < best.compliance_after
                                                : next.after > best.after)
                              : next.reached();
      if (!better) continue;
      best = next;
      kept = problem_.design;
    }
    problem_.design = kept;
    sum.after = best.after;
    sum.compliance_after = best.compliance_after;
    outcome_.clean_up = sum;
    measure(problem_.stages.back());
  }

  bool see(MmcProblem& state, const optim::Iterate& iterate) {
    ++outcome_.iterations;
    if (state.x() != *iterate.x) state.evaluate(*iterate.x);  // a trial came after it
    SharpDesign sharp;
    const bool wanted =
        settings_.sharp_every > 0 && outcome_.iterations % settings_.sharp_every == 0;
    if (wanted) sharp = sharp_design(problem_, state.components(), loads_);
    const bool look = problem_.drop_every > 0 && outcome_.iterations % problem_.drop_every == 0;
    changed_ = look && turnover_->look(state.components());
    std::span<const ComponentEvent> events;
    if (changed_) events = turnover_->events();
    outcome_.events.insert(outcome_.events.end(), events.begin(), events.end());
    if (observe_)
      going_ = observe_({problem_, cycle_, outcome_.iterations,
                         outcome_.evaluations + iterate.evaluations, iterate, state, state.value(),
                         loads_, wanted ? &sharp : nullptr, events});
    state.clear_seconds();
    return going_ && !changed_;
  }

  void finish() {
    outcome_.sharp = sharp_design(problem_, problem_.design.components(), loads_);
    const CellFactors sharp = ersatz_.sharp(outcome_.sharp.fractions);
    const VectorXd each = loads_.individual(sharp.stiffness, sharp.mass);
    outcome_.load_compliances.assign(each.data(), each.data() + each.size());
    outcome_.worst_compliance = each.maxCoeff();
    // The paper's comparison: the volume that was allowed (or came out), spread evenly.
    const bool given = problem_.goal.minimize == Goal::Minimize::compliance;
    const double volume = given ? problem_.goal.max_volume : outcome_.sharp.volume;
    const VectorXd even = VectorXd::Constant(problem_.grid.n_cells(), volume);
    outcome_.uniform_compliance = judged_compliance(problem_, loads_, {even, even});
  }

  BodyProblem& problem_;
  LoadResponse& loads_;
  int cycle_;
  const DesignSettings& settings_;
  const IterationObserver& observe_;
  Ersatz ersatz_;
  Turnover* turnover_ = nullptr;  // of the stage
  BodyOutcome outcome_;
  bool going_ = true, changed_ = false;
};

}  // namespace

BodyOutcome design_body(BodyProblem& problem, LoadResponse& loads, int cycle,
                        const DesignSettings& settings, const IterationObserver& observe,
                        bool& going) {
  BodyDesigner designer(problem, loads, cycle, settings, observe);
  BodyOutcome outcome = designer.go();
  going = !designer.stopped();
  return outcome;
}

}  // namespace flexmorph::mmc
