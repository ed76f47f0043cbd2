#include "optim/mmc/esl_loop.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "optim/mmc/compliance_evaluator.h"

namespace flexmorph::mmc {
namespace {

/// Problems by their place that are solved together: those that share mass, in the place of the
/// first of them, and each of the others by itself.
std::vector<std::vector<size_t>> groups_of(const std::vector<BodyProblem>& problems) {
  std::vector<std::vector<size_t>> out;
  std::optional<size_t> sharing;
  for (size_t i = 0; i < problems.size(); ++i) {
    if (problems[i].shares_mass && sharing) {
      out[*sharing].push_back(i);
      continue;
    }
    if (problems[i].shares_mass) sharing = out.size();
    out.push_back({i});
  }
  return out;
}

/// A body under the loads of a motion, and its design before the cycle.
struct Start {
  VectorXd fractions;
  CellFactors factors;
  std::unique_ptr<ComplianceEvaluator> compliance;
  VectorXd energies;

  Start(const BodyProblem& p, const fem::EslSets& loads)
      : fractions(fractions_of(p, p.design.components())),
        factors(ersatz_of(p).sharp(fractions)),
        compliance(std::make_unique<ComplianceEvaluator>(loads, p.section, p.compliance,
                                                         factors.stiffness, factors.mass)),
        energies(compliance->individual(factors.stiffness, factors.mass)) {}
};

/// The designs of all bodies in one cycle, up to the group that was stopped.
class CycleDesigner {
 public:
  CycleDesigner(std::vector<BodyProblem>& problems, const std::vector<fem::EslSets>& loads)
      : problems_(problems), loads_(loads), outcomes_(problems.size()) {}

  /// @return false when the observer stopped it
  bool go(int cycle, const LoopSettings& settings, const LoopObserver& observer) {
    bool going = true;
    for (const std::vector<size_t>& group : groups_of(problems_)) {
      design(group, cycle, settings, observer, going);
      if (!going) break;
    }
    return going;
  }

  /// Of the bodies up to the first one without.
  std::vector<BodyOutcome> outcomes() {
    std::vector<BodyOutcome> out;
    for (std::optional<BodyOutcome>& o : outcomes_) {
      if (!o) break;
      out.push_back(std::move(*o));
    }
    return out;
  }

 private:
  void design(const std::vector<size_t>& group, int cycle, const LoopSettings& settings,
              const LoopObserver& observer, bool& going) {
    std::vector<std::unique_ptr<Start>> starts;
    std::vector<LoadedBody> bodies;
    for (const size_t i : group) {
      starts.push_back(std::make_unique<Start>(problems_[i], loads_[i]));
      bodies.push_back({problems_[i], *starts.back()->compliance});
    }
    std::vector<BodyOutcome> found =
        design_bodies(bodies, cycle, settings.design, observer.iteration, going);
    for (size_t k = 0; k < group.size(); ++k) {
      BodyOutcome& outcome = outcomes_[group[k]].emplace(std::move(found[k]));
      const std::vector<fem::EslSet>& sets = loads_[group[k]].sets;
      for (size_t l = 0; l < sets.size(); ++l)
        outcome.energy_ratios.push_back(0.5 * starts[k]->energies[static_cast<Eigen::Index>(l)] /
                                        sets[l].strain_energy);
      outcome.design_change = (outcome.sharp.fractions - starts[k]->fractions).cwiseAbs().sum() /
                              ersatz_of(problems_[group[k]]).n_domain_cells();
    }
  }

  std::vector<BodyProblem>& problems_;
  const std::vector<fem::EslSets>& loads_;
  std::vector<std::optional<BodyOutcome>> outcomes_;
};

bool rests(std::span<const BodyOutcome> now, std::span<const BodyOutcome> before,
           double tolerance) {
  if (now.size() != before.size()) return false;
  const auto sum = [](std::span<const BodyOutcome> all) {
    double out = 0;
    for (const BodyOutcome& o : all) out += o.sharp.compliance;
    return out;
  };
  return std::abs(sum(now) - sum(before)) <= tolerance * sum(before);
}

std::vector<fem::Factors> factors_of(const std::vector<BodyProblem>& problems) {
  std::vector<fem::Factors> out;
  for (const BodyProblem& p : problems) out.push_back(dynamic_factors(p, p.design.components()));
  return out;
}

/// Designs and outcomes of the cycles so far, and which one is best.
class Verdicts {
 public:
  void add(int cycle, const std::vector<BodyProblem>& problems,
           const std::vector<BodyOutcome>& outcome) {
    CycleVerdict& v = verdicts_.emplace_back();
    v.cycle = cycle;
    for (const BodyOutcome& o : outcome) {
      v.objective += o.compliance;
      v.bodies.push_back({o.body, o.compliance, o.sharp.compliance, o.design_change});
    }
    outcomes_.push_back(outcome);
    auto& designs = designs_.emplace_back();
    for (const BodyProblem& p : problems) designs.push_back(p.design);
  }
  /// @param strain_energy_integral  of a motion with the designs of the last cycle added
  void record(double strain_energy_integral) {
    CycleVerdict& last = verdicts_.back();
    last.strain_energy_integral = strain_energy_integral;
    const size_t now = verdicts_.size() - 1;
    if (now > 0 && !(last.strain_energy_integral < verdicts_[best_].strain_energy_integral)) return;
    verdicts_[best_].best = false;
    best_ = now;
    last.best = true;
  }
  std::vector<BodyOutcome> take_best(std::vector<BodyProblem>& problems) const {
    for (size_t k = 0; k < problems.size(); ++k) problems[k].design = designs_[best_][k];
    return outcomes_[best_];
  }
  const std::vector<CycleVerdict>& all() const { return verdicts_; }
  bool last_is_best() const { return best_ + 1 == verdicts_.size(); }

 private:
  std::vector<CycleVerdict> verdicts_;
  std::vector<std::vector<BodyOutcome>> outcomes_;
  std::vector<std::vector<Design>> designs_;
  size_t best_ = 0;
};

}  // namespace

std::vector<BodyOutcome> esl_loop(std::vector<BodyProblem>& problems, const Simulate& simulate,
                                  const LoopSettings& settings, const LoopObserver& observer) {
  Verdicts verdicts;
  const auto record = [&](double strain_energy_integral) {
    verdicts.record(strain_energy_integral);
    if (observer.verdict) observer.verdict(verdicts.all());
    return verdicts.last_is_best();
  };
  std::vector<BodyOutcome> outcome;
  for (int cycle = 1; cycle <= settings.max_cycles; ++cycle) {
    const std::vector<fem::Factors> factors = factors_of(problems);
    if (cycle > 1 && settings.verification_motion && !record(settings.verification_motion(factors)))
      return verdicts.take_best(problems);
    const std::vector<fem::EslSets> loads = simulate(factors);
    if (cycle > 1 && !settings.verification_motion && !record(loads.front().strain_energy_integral))
      return verdicts.take_best(problems);
    if (observer.loads) observer.loads(cycle, loads);

    const std::vector<BodyOutcome> before = std::move(outcome);
    CycleDesigner designer(problems, loads);
    const bool going = designer.go(cycle, settings, observer);
    outcome = designer.outcomes();
    if (observer.cycle) observer.cycle(cycle, outcome);
    if (!going) return outcome;
    verdicts.add(cycle, problems, outcome);
    if (rests(outcome, before, settings.tolerance)) break;
  }
  if (verdicts.all().size() < 2) return outcome;
  const std::vector<fem::Factors> factors = factors_of(problems);
  record(settings.verification_motion ? settings.verification_motion(factors)
                                      : simulate(factors).front().strain_energy_integral);
  return verdicts.take_best(problems);
}

}  // namespace flexmorph::mmc
