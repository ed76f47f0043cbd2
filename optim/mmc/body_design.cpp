#include "optim/mmc/body_design.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "optim/mmc/shared_problem.h"
#include "optim/mmc/united_connectivity.h"
#include "optim/search.h"

namespace flexmorph::mmc {
namespace {

/// With a smallest feature, so many times a part of the iterations follows a clean-up.
constexpr int kPolishes = 2, kPolishShare = 6;

/// One of the bodies that are designed together.
struct Part {
  BodyProblem& problem;
  LoadResponse& loads;
  Plate plate;
  Ersatz ersatz;
  const TdfSettings* tdf = nullptr;  // of the stage
  std::optional<Turnover> turnover;  // of the stage
  BodyOutcome outcome;
  optim::Stop stopped = optim::Stop::failed;  // the optimizer, last
  Design next;                                // when a list of components changed: where to go on

  explicit Part(const LoadedBody& body)
      : problem(body.problem),
        loads(body.loads),
        plate(plate_of(problem)),
        ersatz(ersatz_of(problem)),
        next(problem.design) {}

  MmcProblem state() const {
    return {{plate, problem.design, ersatz, loads}, *tdf, problem.goal, problem.places};
  }
};

/// The problem of all parts at their designs: that of the only one, or the shared one.
class Whole {
 public:
  explicit Whole(const std::vector<Part>& parts) {
    states.reserve(parts.size());
    for (const Part& p : parts) states.push_back(p.state());
    if (parts.size() == 1) return;
    std::vector<SharedProblem::Part> all;
    for (size_t k = 0; k < parts.size(); ++k)
      all.push_back({&states[k], parts[k].plate.full_mass()});
    shared_.emplace(std::move(all));
  }
  Whole(const Whole&) = delete;

  optim::Problem& problem() {
    if (shared_) return *shared_;
    return states.front();
  }
  VectorXd part_of(const VectorXd& x, size_t k) const {
    return shared_ ? shared_->part_of(x, k) : x;
  }

  std::vector<MmcProblem> states;

 private:
  std::optional<SharedProblem> shared_;
};

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
                                    [](const Part& p) { return p.problem.min_feature > 0; });
    const int polishes = cleans ? kPolishes : 0;
    const auto share = [&](int total) { return total - polishes * (total / kPolishShare); };
    const int iterations = share(settings_.optimizer.max_iterations);
    const int solves = share(settings_.optimizer.max_evaluations);
    int n_stages = 0;
    for (const Part& p : parts_)
      n_stages = std::max(n_stages, static_cast<int>(p.problem.stages.size()));
    for (int stage = 0; stage < n_stages && going_; ++stage) {
      for (Part& p : parts_) {
        const auto own = static_cast<int>(p.problem.stages.size());
        p.tdf = &p.problem.stages[static_cast<size_t>(stage * own / n_stages)];
      }
      run_stage(iterations * (stage + 1) / n_stages - iterations * stage / n_stages,
                solves * (stage + 1) / n_stages);
    }
    const bool analysed = settings_.optimizer.max_iterations == 0;
    if (cleans && going_ && !analysed) thicken();
    std::vector<BodyOutcome> out;
    for (Part& p : parts_) {
      if (analysed) {
        measure(p);
        p.outcome.stop = "analysed as it starts";
      }
      finish(p);
      out.push_back(std::move(p.outcome));
    }
    return out;
  }
  bool stopped() const { return !going_; }  ///< by the observer

 private:
  /// The best designs of one run of the optimizer.
  struct Candidate {
    std::vector<Design> designs;
    std::vector<double> changes;
    optim::Result result;
    bool newest = true;  ///< do they belong to the last run?
  };

  /// A stage of the bands: runs of the optimizer, a new one whenever a list of components changed.
  /// @param solves  state solves of the cycle after which it ends; 0: no limit
  void run_stage(int left, int solves) {
    for (Part& p : parts_)
      p.turnover.emplace(p.problem.grid, *p.tdf, p.ersatz,
                         p.problem.refill ? p.problem.design.shortest() : 0);
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
  }

  Candidate run(int iterations, int solves) {
    optim::Settings settings = settings_.optimizer;
    settings.max_iterations = iterations;
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
    return feasible_a ? a.response.f <= b.response.f : a.violation <= b.violation;
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
      p.stopped = best.result.stop;
      p.outcome.stop = optim::to_string(best.result.stop) +
                       (best.result.message.empty() ? "" : ": " + best.result.message);
      measure(p);
    }
  }

  /// Blurred figures of a design.
  static void measure(Part& p) {
    MmcProblem state = p.state();
    state.evaluate(state.start());
    // A goal without a compliance has never asked for one.
    p.outcome.compliance = std::isfinite(state.compliance())
                               ? state.compliance()
                               : judged_compliance(p.problem, p.loads, state.factors());
    p.outcome.volume = state.volume();
    for (const ResponseRow* row : further_rows(p.problem.goal))
      p.outcome.further[key_of(*row)] = state.values(*row)->maxCoeff();
  }

  /// The sharp design by its cells, without the widths of its outlines, which cost more than an
  /// analysis does. What hangs together shows in the outlines here, too.
  static SharpDesign without_outlines(const Part& p) {
    SharpDesign out;
    out.fractions = fractions_of(p.problem, p.problem.design.components());
    out.volume = out.fractions.sum() / p.ersatz.n_domain_cells();
    const CellFactors sharp = p.ersatz.sharp(out.fractions);
    const std::vector<Component> components = p.problem.design.components();
    out.compliance = judged_compliance(p.problem, p.loads, sharp);
    out.further = further_values(p.problem, components, p.loads, sharp);
    out.connectivity = united_connectivity(p.problem, components, out.fractions);
    return out;
  }

  /// Designs after a clean-up of all bodies that want one.
  struct Cleaned {
    std::vector<std::optional<CleanUp>> clean_ups;
    std::vector<Design> designs;
    bool reached = true;
    double compliance = 0;                                       ///< of all sharp designs
    double thickness = std::numeric_limits<double>::infinity();  ///< least part of what is wanted

    bool better_than(const Cleaned& other) const {
      if (reached != other.reached) return reached;
      return reached ? compliance < other.compliance : thickness > other.thickness;
    }
  };

  Cleaned clean() {
    // What the budget leaves goes to the bodies as they have shared it so far.
    double used = 0, allowed = 0;
    for (const Part& p : parts_) {
      used += p.plate.full_mass() * p.outcome.volume;
      allowed += p.plate.full_mass() * allowed_volume(p.problem.goal).value_or(1);
    }
    Cleaned out;
    for (Part& p : parts_) {
      std::optional<CleanUp>& done = out.clean_ups.emplace_back();
      if (p.problem.min_feature > 0) {
        std::optional<double> volume;
        if (parts_.size() > 1 && used > 0)
          volume = std::min(1.0, p.outcome.volume * allowed / used);
        done = clean_up(p.problem, p.loads, p.problem.min_feature, volume);
        out.reached = out.reached && done->reached();
        out.thickness = std::min(out.thickness, done->after / done->wanted);
        out.compliance += done->compliance_after;
      } else {
        const VectorXd fractions = fractions_of(p.problem, p.problem.design.components());
        out.compliance += judged_compliance(p.problem, p.loads, p.ersatz.sharp(fractions));
      }
      out.designs.push_back(p.problem.design);
    }
    return out;
  }

  /// Makes the designs as thick as wanted; then optimizes from there, and does it again: what was
  /// put over narrow places is shaped as well. The least compliant of the thick ones are kept,
  /// those of one round together: mass that one body gave, another has.
  void thicken() {
    Cleaned best = clean();
    std::vector<std::optional<CleanUp>> sums = best.clean_ups;
    const int budget = settings_.optimizer.max_evaluations;
    for (int round = 1; round <= kPolishes && going_; ++round) {
      run_stage(settings_.optimizer.max_iterations / kPolishShare,
                budget - (kPolishes - round) * (budget / kPolishShare));
      Cleaned next = clean();
      for (size_t k = 0; k < parts_.size(); ++k) {
        if (!sums[k]) continue;
        sums[k]->rounds += next.clean_ups[k]->rounds;
        sums[k]->patches += next.clean_ups[k]->patches;
        sums[k]->dropped += next.clean_ups[k]->dropped;
      }
      if (next.better_than(best)) best = std::move(next);
    }
    for (size_t k = 0; k < parts_.size(); ++k) {
      Part& p = parts_[k];
      p.problem.design = best.designs[k];
      if (sums[k]) {
        sums[k]->after = best.clean_ups[k]->after;
        sums[k]->compliance_after = best.clean_ups[k]->compliance_after;
        p.outcome.clean_up = sums[k];
      }
      measure(p);
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
    const bool look = p.problem.drop_every > 0 && iterations_ % p.problem.drop_every == 0;
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
    // Stages and changes of components stop the optimizer, too: that is no reason of the whole.
    if (!going_)
      out.stop = "interrupted after " + std::to_string(iterations_) + " iterations";
    else if (!analysed &&
             (p.stopped == optim::Stop::iteration_limit || p.stopped == optim::Stop::observer))
      out.stop = "iteration limit: " + std::to_string(iterations_) + " iterations, KKT residual " +
                 optim::scientific(out.kkt);
    out.sharp = analysed ? without_outlines(p)
                         : sharp_design(p.problem, p.problem.design.components(), p.loads);
    const CellFactors sharp = p.ersatz.sharp(out.sharp.fractions);
    const VectorXd each = p.loads.individual(sharp.stiffness, sharp.mass);
    out.load_compliances.assign(each.data(), each.data() + each.size());
    out.worst_compliance = each.maxCoeff();
    if (settings_.condition) out.condition = p.loads.condition();
    // The paper's comparison: the volume that was allowed (or came out), spread evenly.
    const double volume = allowed_volume(p.problem.goal).value_or(out.sharp.volume);
    const VectorXd even = VectorXd::Constant(p.problem.grid.n_cells(), volume);
    out.uniform_compliance = judged_compliance(p.problem, p.loads, {even, even});
    out.factorizations = p.loads.factorizations();
  }

  std::vector<Part> parts_;
  int cycle_;
  const DesignSettings& settings_;
  const IterationObserver& observe_;
  int iterations_ = 0, evaluations_ = 0;  // of the cycle
  bool going_ = true, changed_ = false;
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

BodyOutcome design_body(BodyProblem& problem, LoadResponse& loads, int cycle,
                        const DesignSettings& settings, const IterationObserver& observe,
                        bool& going) {
  const LoadedBody body{problem, loads};
  return design_bodies({&body, 1}, cycle, settings, observe, going).front();
}

}  // namespace flexmorph::mmc
