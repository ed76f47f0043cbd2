#include "optim/mmc/body_design.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "geometry/cpu_time.h"
#include "optim/mmc/designed_parts.h"
#include "optim/mmc/mended_parts.h"
#include "optim/mmc/usability.h"
#include "optim/search.h"

namespace flexmorph::mmc {
namespace {

/// Where widths are wanted, so many times a part of the iterations follows a clean-up.
constexpr int kPolishes = 3, kPolishShare = 8;
/// A design is brought to its limits in so many tries at most, each of at least so many iterations.
constexpr int kLimitTries = 4, kFewestLimitIterations = 15;
/// A limit of a blurred design is active that is met by less than this part.
constexpr double kBinding = 0.02;
/// Gaps that are narrower than this part of what is wanted are closed before the polishes, which
/// open the others.
constexpr double kClosed = 0.5;

/// One cycle's design problem of one body, or of several together.
class Designer {
 public:
  Designer(std::span<const LoadedBody> bodies, int cycle, const DesignSettings& settings,
           const IterationObserver& observe)
      : parts_(bodies.begin(), bodies.end()),
        cycle_(cycle),
        settings_(settings),
        observe_(observe) {}

  std::vector<BodyOutcome> go() {
    // Stages share iterations and state solves evenly; polishes after a clean-up have their part.
    const bool cleans = std::any_of(parts_.begin(), parts_.end(),
                                    [](const Part& p) { return p.problem.widths.any(); });
    const bool shapes = settings_.optimizer.max_iterations >= kFewestMendedIterations;
    const int polishes = cleans && shapes ? kPolishes : 0;
    const auto share = [&](int total) { return total - polishes * (total / kPolishShare); };
    const int iterations = share(settings_.optimizer.max_iterations);
    const int solves = share(settings_.optimizer.max_evaluations);
    const bool analysed = settings_.optimizer.max_iterations == 0;
    run_starts(analysed ? 1 : n_starts(), iterations, solves);
    if (cleans && going_ && !analysed) mend(polishes);
    if (settings_.finish && going_ && !analysed) {
      if (cleans)
        finish_mended(solves);
      else
        last_solve(solves);
    }
    if (analysed)
      evaluate();
    else if (going_)
      meet_limits();
    std::vector<BodyOutcome> out;
    parts_.front().outcome.seconds_mending = mending_;
    for (Part& p : parts_) {
      finish(p);
      out.push_back(std::move(p.outcome));
    }
    return out;
  }
  bool stopped() const { return !going_; }  ///< by the observer

 private:
  size_t n_starts() const {
    size_t out = 1;
    for (const Part& p : parts_)
      if (cycle_ == 1) out = std::max(out, 1 + p.problem.further_starts.size());
    return out;
  }

  /// The best designs of one run of the optimizer.
  struct Candidate {
    std::vector<Design> designs;
    std::vector<double> changes;
    optim::Result result;
    bool newest = true;  ///< do they belong to the last run?
  };

  /// All stages from every start, of which the best is taken: what they come to at the last band
  /// says which layout is best after mending, what they come to at the first one does not.
  /// @param iterations  of each start
  /// @param solves      of all starts, and of the last solve
  void run_starts(size_t n_starts, int iterations, int solves) {
    std::vector<Design> first;
    for (const Part& p : parts_) first.push_back(p.problem.design);
    const int shares = static_cast<int>(n_starts) * n_stages() + (settings_.finish ? 1 : 0);
    std::optional<Candidate> best;
    int used = 0;
    for (size_t start = 0; start < n_starts && going_; ++start) {
      for (size_t k = 0; k < parts_.size(); ++k) {
        const std::vector<Design>& further = parts_[k].problem.further_starts;
        parts_[k].problem.design =
            start == 0 || further.empty() ? first[k] : further[std::min(start, further.size()) - 1];
      }
      std::optional<Candidate> found = run_stages(iterations, solves, used, shares);
      // One that was stopped on its way, or had no solves left, compares with none.
      const bool newest = found && (!best || (going_ && better(found->result, best->result)));
      if (newest) best = std::move(found);
      if (best) best->newest = newest;
      for (Part& p : parts_)
        if (newest) p.outcome.start = static_cast<int>(start) + 1;
    }
    if (best && !best->newest) settle(*best);
  }

  int n_stages() const {
    size_t out = 0;
    for (const Part& p : parts_) out = std::max(out, p.problem.stages.size());
    return static_cast<int>(out);
  }

  /// From coarse to fine bands.
  /// @param used  stages that had their share of the solves; counted on
  /// @return the best of the last stage; none where no iteration was left for it
  std::optional<Candidate> run_stages(int iterations, int solves, int& used, int shares) {
    std::optional<Candidate> out;
    const int n = n_stages();
    for (int stage = 0; stage < n && going_; ++stage) {
      for (Part& p : parts_) {
        const auto own = static_cast<int>(p.problem.stages.size());
        p.tdf = &p.problem.stages[static_cast<size_t>(stage * own / n)];
      }
      ++used;
      out =
          run_stage(iterations * (stage + 1) / n - iterations * stage / n, solves * used / shares);
    }
    return out;
  }

  /// A stage of the bands: runs of the optimizer, a new one whenever a list of components changed.
  /// @param solves  state solves of the cycle after which it ends; 0: no limit
  /// @return its best designs, which are those of the parts now; none without an iteration
  std::optional<Candidate> run_stage(int left, int solves) {
    for (Part& p : parts_)
      p.turnover.emplace(p.problem.grid, *p.tdf, p.ersatz,
                         p.problem.refill ? p.problem.design.shortest() : 0,
                         p.problem.design.n_images());
    std::optional<Candidate> best;
    while (left > 0 && going_ && (solves == 0 || evaluations_ < solves)) {
      Candidate found = run(left, solves);
      left -= found.result.iterations;
      if (!best || better(found.result, best->result)) {
        best = std::move(found);
        best->newest = true;
      } else {
        best->newest = false;
      }
      if (!changed_) break;
      changed_ = false;
      for (Part& p : parts_) p.problem.design = p.next;
    }
    if (best) settle(*best);
    return best;
  }

  /// Components stay as they are in it: what it converges to is what it began with.
  void last_solve(int solves) {
    solver_ = &*settings_.finish;
    drops_ = false;
    run_stage(solver_->max_iterations, solves);
    solver_ = &settings_.optimizer;
    drops_ = true;
  }

  Candidate run(int iterations, int solves) {
    optim::Settings settings = *solver_;
    settings.max_iterations = iterations;
    settings.plateau = drops_;  // a last solve goes to the KKT conditions
    // Who comes last sees to the KKT conditions.
    if (settings_.finish && drops_) settings.rest.kkt = std::numeric_limits<double>::infinity();
    settings.max_evaluations = solves > 0 ? solves - evaluations_ : 0;
    Whole whole(parts_);
    const auto watch = [&](const optim::Iterate& iterate) { return see(whole, iterate); };
    Candidate out;
    std::optional<optim::RecordedProblem> recorded;
    if (settings_.past) recorded.emplace(whole.problem(), settings_.past->log);
    optim::Problem& problem = recorded ? *recorded : whole.problem();
    out.result = optim::make_optimizer(settings)->minimize(problem, watch);
    for (size_t k = 0; k < parts_.size(); ++k) {
      out.designs.push_back(parts_[k].problem.design);
      out.changes.push_back(
          out.designs.back().move_to(whole.states[k].design_part(whole.part_of(out.result.x, k))));
    }
    evaluations_ += out.result.evaluations;
    return out;
  }

  bool better(const optim::Result& a, const optim::Result& b) const {
    const double tolerance = settings_.optimizer.feasibility;
    const bool feasible_a = a.violation <= tolerance, feasible_b = b.violation <= tolerance;
    if (feasible_a != feasible_b) return feasible_a;
    return feasible_a
               ? optim::attained_objective(a.response) <= optim::attained_objective(b.response)
               : a.violation <= b.violation;
  }

  /// Takes the best designs of a stage.
  void settle(const Candidate& best) {
    for (size_t k = 0; k < parts_.size(); ++k) {
      Part& p = parts_[k];
      p.problem.design = best.designs[k];
      if (!best.newest)
        p.outcome.events.push_back(
            {ComponentEvent::Kind::restored, 0, best.designs[k].n_components()});
      p.outcome.change = best.changes[k];
      p.outcome.kkt = best.result.kkt;
      p.outcome.verdict = best.result.verdict;
      p.stopped = best.result.stop;
      p.outcome.stop = optim::to_string(best.result.stop) +
                       (best.result.message.empty() ? "" : ": " + best.result.message);
      measure(p);
    }
  }

  /// Makes designs as wide as wanted; then optimizes from there with the widths as constraints, so
  /// that what was put over narrow places is shaped as well, and does it again. The least compliant
  /// of the wide ones are kept, those of one round together: mass that one body gave, another has.
  void mend(int polishes) {
    for (Part& p : parts_) p.problem.design = p.problem.design.without_symmetry();
    std::vector<CleanUp> renewals(parts_.size());
    if (polishes > 0) {
      const Mending timed(*this);
      renewals = renewed(parts_, settings_.go_on);
    }
    Mended last = repaired_all(polishes > 0 ? kClosed : 1, true);
    Mended best = last;
    std::vector<std::optional<CleanUp>> sums = last.clean_ups;
    for (size_t k = 0; k < parts_.size(); ++k)
      if (sums[k]) sums[k]->add(renewals[k]);
    const int budget = settings_.optimizer.max_evaluations;
    for (int round = 1; round <= polishes && going_; ++round) {
      for (size_t k = 0; k < parts_.size(); ++k) {
        Part& p = parts_[k];
        p.widths.reset();
        const std::optional<CleanUp>& done = last.clean_ups[k];
        if (done && !done->given_up) p.widths.emplace(p.problem, p.problem.widths);
        follow_crisp(p);
      }
      run_stage(settings_.optimizer.max_iterations / kPolishShare,
                budget - (polishes - round) * (budget / kPolishShare));
      last = repaired_all(1, round == polishes);
      for (size_t k = 0; k < parts_.size(); ++k)
        if (sums[k]) sums[k]->add(*last.clean_ups[k]);
      if (last.better_than(best)) best = last;
    }
    for (size_t k = 0; k < parts_.size(); ++k)
      if (sums[k]) parts_[k].outcome.clean_up = sums[k];
    deliver(best);
  }

  /// Adds the CPU time of its scope to that of repairs.
  class Mending {
   public:
    explicit Mending(Designer& designer) : sum_(designer.mending_) {}
    ~Mending() { sum_ += cpu_seconds() - begin_; }
    Mending(const Mending&) = delete;
    Mending& operator=(const Mending&) = delete;

   private:
    double& sum_;
    double begin_ = cpu_seconds();
  };

  Mended repaired_all(double gaps, bool trims) {
    const Mending timed(*this);
    Mended out = repaired(parts_, gaps, trims, settings_.go_on);
    if (settings_.go_on && !settings_.go_on()) going_ = false;
    return out;
  }

  /// The last solve of mended designs: without limits of widths, which have no second derivatives.
  /// What it comes to is looked over, and taken where widths are as wanted all the same; where
  /// there is something to repair, that is done, and solved once more.
  void finish_mended(int solves) {
    const Mended before = as_they_are(parts_);
    for (int k = 0; k < kFinishTries && going_; ++k) {
      for (Part& p : parts_) {
        p.widths.reset();
        follow_crisp(p);
      }
      last_solve(solves);
      const Mended found = looked_over(parts_);
      const bool wide = found.reached && !found.changed;
      if (wide && std::all_of(parts_.begin(), parts_.end(), keeps_volume)) return take(found);
      if (!wide && k + 1 < kFinishTries) repaired_all(1, true);
    }
    deliver(before);
    for (Part& p : parts_)
      p.outcome.stop += "; the last solve made widths too small and was taken back";
  }

  /// Brings crisp designs to their limits on responses of the loads: an active one is met within
  /// kLimitTolerance from either side. Where no try comes so far the closest one is taken.
  void meet_limits() {
    if (std::none_of(parts_.begin(), parts_.end(), limits_state)) return;
    drops_ = false;
    double least = std::numeric_limits<double>::infinity();
    std::vector<Design> closest;
    int k = 0;
    for (; going_; ++k) {
      double miss = 0;
      for (Part& p : parts_) miss = std::max(miss, crisp_miss(p));
      if (miss < least) {
        least = miss;
        closest.clear();
        for (const Part& p : parts_) closest.push_back(p.problem.design);
      }
      if (least <= kLimitTolerance || k == kLimitTries) break;
      for (Part& p : parts_) follow_crisp(p);
      run_stage(std::max(kFewestLimitIterations, settings_.optimizer.max_iterations / kPolishShare),
                0);
    }
    drops_ = true;
    if (k == 0) return;  // limits are met as they are
    for (size_t i = 0; i < parts_.size(); ++i) {
      Part& p = parts_[i];
      p.problem.design = closest[i];
      if (least > kLimitTolerance && limits_state(p)) thicken_to_limits(p);
      measure(p);
      follow_crisp(p);
    }
    record_kkt();
  }

  /// Makes all components thicker or thinner by the same amount, at most a cell, until the crisp
  /// design just keeps to its limits on responses of the loads.
  static void thicken_to_limits(Part& p) {
    constexpr int kHalvings = 12;
    const Design from = p.problem.design;
    const std::vector<Component> components = from.components();
    const double thinnest = p.tdf->min_half_thickness;
    const auto excess_with = [&](double more) {
      std::vector<Component> thicker = components;
      for (Component& c : thicker)
        for (double* half : {&c.c1, &c.c2, &c.c3})
          *half = std::max(*half + more, std::min(*half, thinnest));
      p.problem.design = from.with(thicker);
      const SharpDesign crisp = crisp_figures(p);
      double out = -1;
      for (const Limit& limit : p.problem.goal.limits)
        if (limit.row->needs_state() && !limit.row->of_motion)
          out = std::max(out, limit.excess(crisp_value(*limit.row, p.problem.goal, crisp)));
      return out;
    };
    double thin = -p.problem.grid.dx(), thick = -thin;
    if (excess_with(thick) > 0 || excess_with(thin) < 0) {
      p.problem.design = from;
      return;
    }
    for (int k = 0; k < kHalvings; ++k) {
      const double middle = 0.5 * (thin + thick);
      (excess_with(middle) > 0 ? thin : thick) = middle;
    }
    excess_with(thick);
  }

  /// Largest part by which the crisp design is beyond its limits on responses of the loads. Where
  /// less material is wanted the limit that is nearest has to be used; elsewhere one that binds the
  /// blurred design has to.
  static double crisp_miss(Part& p) {
    const Goal& goal = p.problem.goal;
    const Goal seen = blurred(goal, p.crisp_ratios);
    const SharpDesign crisp = crisp_figures(p);
    MmcProblem state = p.state();
    state.evaluate(state.start());
    double beyond = -1, unused = 0;
    for (size_t i = 0; i < goal.limits.size(); ++i) {
      const Limit& limit = goal.limits[i];
      if (!limit.row->needs_state() || limit.row->of_motion) continue;
      const double excess = limit.excess(crisp_value(*limit.row, goal, crisp));
      beyond = std::max(beyond, excess);
      if (seen.limits[i].excess(state.values(*limit.row)->maxCoeff()) > -kBinding)
        unused = std::max(unused, -excess);
    }
    return goal.objective->falls_with_material() ? std::max(beyond, unused) : std::abs(beyond);
  }

  /// Is the sharp volume what is allowed, or less because more serves nothing?
  static bool keeps_volume(const Part& p) {
    constexpr double kOff = 5e-4;
    const std::optional<double> allowed = allowed_volume(p.problem.goal);
    const double sharp =
        fractions_of(p.problem, p.problem.design.components()).sum() / p.ersatz.n_domain_cells();
    // What the solver saw.
    const auto ratio = p.crisp_ratios.find(key_of(kVolume));
    const double seen = (ratio == p.crisp_ratios.end() ? 1 : ratio->second) * p.outcome.volume;
    return !allowed || p.problem.shares_mass || std::abs(sharp - seen) <= kOff * *allowed;
  }

  void take(const Mended& mended) {
    for (size_t k = 0; k < parts_.size(); ++k) {
      Part& p = parts_[k];
      p.problem.design = mended.designs[k];
      if (p.outcome.clean_up) p.outcome.clean_up->end_as(*mended.clean_ups[k]);
      measure(p);
    }
  }

  /// Evaluates the designs as they are, as delivered ones are: without an iteration.
  void evaluate() {
    for (Part& p : parts_) {
      measure(p);
      p.outcome.stop = "evaluated: nothing was optimized";
      follow_crisp(p);
      if (p.problem.widths.any()) p.widths.emplace(p.problem, p.problem.widths);
    }
    record_kkt();
  }

  /// Takes them with the KKT residual that they have as they are, widths and sharp volume included.
  void deliver(const Mended& mended) {
    take(mended);
    for (size_t k = 0; k < parts_.size(); ++k) {
      Part& p = parts_[k];
      follow_crisp(p);
      p.widths.reset();
      if (const auto& done = mended.clean_ups[k]; done && !done->given_up)
        p.widths.emplace(p.problem, p.problem.widths);
    }
    record_kkt();
  }

  /// Computes the KKT residual of the designs as they are; above the tolerance they have not
  /// converged.
  void record_kkt() {
    Whole whole(parts_);
    optim::Problem& problem = whole.problem();
    const VectorXd x = problem.start();
    // The sharp volume is what is allowed to 2e-4 only, and counts as a limit that is met.
    constexpr double kActive = 1e-3;
    const double kkt =
        optim::kkt_residual(problem.evaluate(x), x, problem.lower(), problem.upper(), kActive);
    for (Part& p : parts_) {
      p.outcome.kkt = p.outcome.verdict.kkt = kkt;
      if (p.outcome.verdict.kind == optim::Verdict::Kind::converged &&
          kkt > settings_.optimizer.kkt_tolerance)
        p.outcome.verdict.kind = optim::Verdict::Kind::unfinished;
    }
  }

  bool see(Whole& whole, const optim::Iterate& iterate) {
    ++iterations_;
    for (size_t k = 0; k < parts_.size(); ++k) {
      MmcProblem& state = whole.states[k];
      const VectorXd x = whole.part_of(*iterate.x, k);
      if (state.x() != x) state.recall(x, {});  // a trial came after it
      see(parts_[k], state, iterate, k == 0);
    }
    return going_ && !changed_;
  }

  void see(Part& p, MmcProblem& state, const optim::Iterate& iterate, bool first) {
    const bool look = drops_ && p.problem.drop_every > 0 && iterations_ % p.problem.drop_every == 0;
    std::span<const ComponentEvent> events;
    p.next = p.problem.design;
    if (look && p.turnover->look(state.components())) {
      changed_ = true;
      events = p.turnover->events();
      p.next = p.problem.design.with(p.turnover->next());
    } else {
      p.next.move_to(state.design_part(state.x()));
    }
    p.outcome.events.insert(p.outcome.events.end(), events.begin(), events.end());
    const Past* past = settings_.past;
    if (past && past->log.knew_last() &&
        past->has_row({p.problem.body, cycle_, iterations_, events}))
      return;
    if (!state.is_solved()) state.evaluate(VectorXd(state.x()));
    SharpDesign sharp;
    const bool wanted = settings_.sharp_every > 0 && iterations_ % settings_.sharp_every == 0;
    if (wanted) sharp = sharp_design(p.problem, state.components(), p.loads);
    optim::Iterate own = iterate;
    own.x = &state.x();
    if (!first) own.seconds = 0;
    if (observe_ &&
        !observe_({p.problem, cycle_, iterations_, evaluations_ + iterate.evaluations, own, state,
                   state.value(), p.loads, wanted ? &sharp : nullptr, events}))
      going_ = false;
    state.clear_seconds();
  }

  void finish(Part& p) const {
    BodyOutcome& out = p.outcome;
    out.body = p.problem.body;
    out.n_loads = p.loads.n_loads();
    out.n_right_hand_sides = p.loads.n_right_hand_sides();
    out.iterations = iterations_;
    out.evaluations = evaluations_;
    const bool analysed = settings_.optimizer.max_iterations == 0;
    if (analysed)
      out.verdict.kind = optim::Verdict::Kind::evaluated;
    else if (!going_)
      out.verdict.kind = optim::Verdict::Kind::unfinished;
    // Stages and changes of components stop the optimizer, too: that is no reason of the whole.
    if (!going_)
      out.stop = "interrupted after " + std::to_string(iterations_) + " iterations";
    else if (!analysed &&
             (p.stopped == optim::Stop::iteration_limit || p.stopped == optim::Stop::observer))
      out.stop = "iteration limit: " + std::to_string(iterations_) + " iterations, KKT residual " +
                 optim::scientific(out.kkt);
    finish_outcome(p, settings_.condition);
  }

  std::vector<Part> parts_;
  int cycle_;
  const DesignSettings& settings_;
  const IterationObserver& observe_;
  int iterations_ = 0, evaluations_ = 0;  // of the cycle
  double mending_ = 0;                    // CPU seconds
  bool going_ = true, changed_ = false;
  const optim::Settings* solver_ = &settings_.optimizer;  // of the stage
  bool drops_ = true;
};

}  // namespace

std::vector<BodyOutcome> design_bodies(std::span<const LoadedBody> bodies, int cycle,
                                       const DesignSettings& settings,
                                       const IterationObserver& observe, bool& going) {
  Designer designer(bodies, cycle, settings, observe);
  std::vector<BodyOutcome> outcomes = designer.go();
  going = !designer.stopped();
  return outcomes;
}

BodyOutcome design_body(BodyProblem& problem, ComplianceEvaluator& loads, int cycle,
                        const DesignSettings& settings, const IterationObserver& observe,
                        bool& going) {
  const LoadedBody body{problem, loads};
  return design_bodies({&body, 1}, cycle, settings, observe, going).front();
}

}  // namespace flexmorph::mmc
