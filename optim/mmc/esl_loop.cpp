#include "optim/mmc/esl_loop.h"

#include <algorithm>
#include <cmath>

namespace flexmorph::mmc {
namespace {

Ersatz ersatz_of(const BodyProblem& p) { return {p.grid, p.stages.back().alpha, p.solid, p.empty}; }

VectorXd fractions_of(const BodyProblem& p, std::span<const Component> components) {
  return area_fractions(p.grid, components, p.stages.back().min_half_thickness, p.solid, p.empty);
}

/// One cycle's design problem of one body.
class BodyCycle {
 public:
  BodyCycle(BodyProblem& problem, const fem::EslSets& loads, int cycle,
            const LoopSettings& settings, const LoopObserver& observer)
      : problem_(problem),
        cycle_(cycle),
        settings_(settings),
        observer_(observer),
        ersatz_(ersatz_of(problem)),
        start_(problem.design.components()),
        start_factors_(ersatz_.sharp(fractions_of(problem, start_))),
        compliance_(loads, problem.section, problem.compliance, start_factors_.stiffness,
                    start_factors_.mass) {
    const VectorXd start = compliance_.individual(start_factors_.stiffness, start_factors_.mass);
    for (size_t i = 0; i < loads.sets.size(); ++i)
      outcome_.energy_ratios.push_back(0.5 * start[static_cast<Eigen::Index>(i)] /
                                       loads.sets[i].strain_energy);
  }

  BodyOutcome go() {
    outcome_.body = problem_.body;
    outcome_.n_loads = compliance_.n_loads();
    outcome_.n_right_hand_sides = compliance_.n_right_hand_sides();
    const auto n_stages = static_cast<int>(problem_.stages.size());
    for (int stage = 0; stage < n_stages && going_; ++stage) run_stage(stage, n_stages);
    finish();
    return std::move(outcome_);
  }
  bool stopped() const { return !going_; }  ///< by the observer

 private:
  void run_stage(int stage, int n_stages) {
    optim::Settings settings = settings_.optimizer;
    const int total = settings.max_iterations;
    settings.max_iterations = total * (stage + 1) / n_stages - total * stage / n_stages;
    if (settings.max_iterations < 1) return;
    MmcProblem state(problem_.grid, problem_.design, ersatz_, compliance_,
                     problem_.stages[static_cast<size_t>(stage)], problem_.max_volume);
    const auto watch = [&](const optim::Iterate& iterate) { return see(state, iterate); };
    const optim::Result best = optim::make_optimizer(settings)->minimize(state, watch);
    outcome_.change = problem_.design.move_to(best.x);
    outcome_.kkt = best.kkt;
    outcome_.evaluations += best.evaluations;
    outcome_.stop = optim::to_string(best.stop) + (best.message.empty() ? "" : ": " + best.message);
    state.evaluate(best.x);
    outcome_.compliance = state.compliance();
    outcome_.volume = state.volume();
  }

  bool see(MmcProblem& state, const optim::Iterate& iterate) {
    ++outcome_.iterations;
    if (state.x() != *iterate.x) state.evaluate(*iterate.x);  // a trial came after it
    SharpDesign sharp;
    const bool wanted =
        settings_.sharp_every > 0 && outcome_.iterations % settings_.sharp_every == 0;
    if (wanted) sharp = sharp_design(problem_, state.components(), compliance_);
    if (observer_.iteration)
      going_ = observer_.iteration({problem_, cycle_, outcome_.iterations,
                                    outcome_.evaluations + iterate.evaluations, iterate, state,
                                    state.value(), compliance_, wanted ? &sharp : nullptr});
    return going_;
  }

  void finish() {
    const std::vector<Component> components = problem_.design.components();
    outcome_.sharp = sharp_design(problem_, components, compliance_);
    const CellFactors sharp = ersatz_.sharp(outcome_.sharp.fractions);
    const VectorXd each = compliance_.individual(sharp.stiffness, sharp.mass);
    outcome_.load_compliances.assign(each.data(), each.data() + each.size());
    // The paper's comparison: the volume that was allowed, spread evenly.
    const VectorXd even = VectorXd::Constant(problem_.grid.n_cells(), problem_.max_volume);
    Compliance::Value value;
    compliance_.evaluate(even, even, value);
    outcome_.uniform_compliance = value.f;
  }

  BodyProblem& problem_;
  int cycle_;
  const LoopSettings& settings_;
  const LoopObserver& observer_;
  Ersatz ersatz_;
  std::vector<Component> start_;
  CellFactors start_factors_;
  Compliance compliance_;
  BodyOutcome outcome_;
  bool going_ = true;
};

bool rests(std::span<const BodyOutcome> now, std::span<const BodyOutcome> before,
           double tolerance) {
  if (now.size() != before.size()) return false;
  for (size_t i = 0; i < now.size(); ++i)
    if (std::abs(now[i].sharp.compliance - before[i].sharp.compliance) >
        tolerance * before[i].sharp.compliance)
      return false;
  return true;
}

}  // namespace

SharpDesign sharp_design(const BodyProblem& problem, std::span<const Component> components,
                         Compliance& compliance) {
  SharpDesign out;
  out.fractions = fractions_of(problem, components);
  out.volume = out.fractions.mean();
  out.connectivity = connectivity(problem.grid, out.fractions);
  const CellFactors factors = ersatz_of(problem).sharp(out.fractions);
  Compliance::Value value;
  compliance.evaluate(factors.stiffness, factors.mass, value);
  out.compliance = value.f;
  return out;
}

fem::Factors dynamic_factors(const BodyProblem& problem, std::span<const Component> components) {
  CellFactors f =
      Ersatz::dynamic(fractions_of(problem, components), problem.stiffness_void, problem.mass_void);
  return {problem.grid, std::move(f.stiffness), std::move(f.mass)};
}

namespace {

std::vector<fem::EslSets> move(const std::vector<BodyProblem>& problems, const Simulate& simulate) {
  std::vector<fem::Factors> factors;
  for (const BodyProblem& p : problems)
    factors.push_back(dynamic_factors(p, p.design.components()));
  return simulate(factors);
}

/// Designs and outcomes of the cycles so far, and which one is best.
class Verdicts {
 public:
  void add(int cycle, const std::vector<BodyProblem>& problems,
           const std::vector<BodyOutcome>& outcome) {
    verdicts_.push_back({cycle, 0, false});
    outcomes_.push_back(outcome);
    auto& x = designs_.emplace_back();
    for (const BodyProblem& p : problems) x.push_back(p.design.x());
  }
  /// The motion with the designs of the last cycle added.
  void judge(const std::vector<fem::EslSets>& motion) {
    if (!verdicts_.empty())
      verdicts_.back().strain_energy_integral = motion.front().strain_energy_integral;
  }
  std::vector<BodyOutcome> take_best(std::vector<BodyProblem>& problems) {
    const auto best = std::min_element(verdicts_.begin(), verdicts_.end(),
                                       [](const CycleVerdict& a, const CycleVerdict& b) {
                                         return a.strain_energy_integral < b.strain_energy_integral;
                                       });
    best->best = true;
    const auto i = static_cast<size_t>(best - verdicts_.begin());
    for (size_t k = 0; k < problems.size(); ++k) problems[k].design.move_to(designs_[i][k]);
    return outcomes_[i];
  }
  const std::vector<CycleVerdict>& all() const { return verdicts_; }

 private:
  std::vector<CycleVerdict> verdicts_;
  std::vector<std::vector<BodyOutcome>> outcomes_;
  std::vector<std::vector<VectorXd>> designs_;
};

}  // namespace

std::vector<BodyOutcome> esl_loop(std::vector<BodyProblem>& problems, const Simulate& simulate,
                                  const LoopSettings& settings, const LoopObserver& observer) {
  Verdicts verdicts;
  std::vector<BodyOutcome> outcome;
  bool stopped = false;
  for (int cycle = 1; cycle <= settings.max_cycles && !stopped; ++cycle) {
    const std::vector<fem::EslSets> loads = move(problems, simulate);
    verdicts.judge(loads);
    if (observer.loads) observer.loads(cycle, loads);

    std::vector<BodyOutcome> before = std::move(outcome);
    outcome.clear();
    for (size_t i = 0; i < problems.size() && !stopped; ++i) {
      BodyCycle body(problems[i], loads[i], cycle, settings, observer);
      outcome.push_back(body.go());
      stopped = body.stopped();
    }
    if (observer.cycle) observer.cycle(cycle, outcome);
    verdicts.add(cycle, problems, outcome);
    if (rests(outcome, before, settings.tolerance)) break;
  }
  if (stopped || verdicts.all().size() < 2) return outcome;
  verdicts.judge(move(problems, simulate));
  outcome = verdicts.take_best(problems);
  if (observer.verdict) observer.verdict(verdicts.all());
  return outcome;
}

}  // namespace flexmorph::mmc
