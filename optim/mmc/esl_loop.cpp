#include "optim/mmc/esl_loop.h"

#include <algorithm>
#include <cmath>

namespace flexmorph::mmc {
namespace {

/// One cycle's design problem of one body, under the loads of a motion.
BodyOutcome design_under(BodyProblem& problem, const fem::EslSets& loads, int cycle,
                         const LoopSettings& settings, const LoopObserver& observer, bool& going) {
  const CellFactors start =
      ersatz_of(problem).sharp(fractions_of(problem, problem.design.components()));
  Compliance compliance(loads, problem.section, problem.compliance, start.stiffness, start.mass);
  const VectorXd energies = compliance.individual(start.stiffness, start.mass);
  BodyOutcome outcome =
      design_body(problem, compliance, cycle, settings.design, observer.iteration, going);
  for (size_t i = 0; i < loads.sets.size(); ++i)
    outcome.energy_ratios.push_back(0.5 * energies[static_cast<Eigen::Index>(i)] /
                                    loads.sets[i].strain_energy);
  return outcome;
}

bool rests(std::span<const BodyOutcome> now, std::span<const BodyOutcome> before,
           double tolerance) {
  if (now.size() != before.size()) return false;
  for (size_t i = 0; i < now.size(); ++i)
    if (std::abs(now[i].sharp.compliance - before[i].sharp.compliance) >
        tolerance * before[i].sharp.compliance)
      return false;
  return true;
}

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
    auto& designs = designs_.emplace_back();
    for (const BodyProblem& p : problems) designs.push_back(p.design);
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
    for (size_t k = 0; k < problems.size(); ++k) problems[k].design = designs_[i][k];
    return outcomes_[i];
  }
  const std::vector<CycleVerdict>& all() const { return verdicts_; }

 private:
  std::vector<CycleVerdict> verdicts_;
  std::vector<std::vector<BodyOutcome>> outcomes_;
  std::vector<std::vector<Design>> designs_;
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
      bool going = true;
      outcome.push_back(design_under(problems[i], loads[i], cycle, settings, observer, going));
      stopped = !going;
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
