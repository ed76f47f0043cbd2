#include "optim/mmc/cycles/esl_loop.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "optim/mmc/cycles/usability.h"
#include "optim/mmc/loads/compliance_evaluator.h"
#include "optim/mmc/problem/finished_part.h"

namespace flexmorph::mmc {
namespace {

/// Returns groups of indices of problems that are solved together. The problems that share mass
/// form one group at the position of the first one; each other problem forms a group of its own.
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

/// The design of a body before the cycle, with its static energies under the loads of the cycle.
struct Start {
  VectorXd fractions;
  CellScaleFactors factors;
  std::unique_ptr<ComplianceEvaluator> compliance;
  VectorXd energies;

  Start(const BodyProblem& p, const fem::EslSets& loads)
      : fractions(part_fractions(p, p.design.components())),
        factors(ersatz_of(p).crisp(fractions)),
        compliance(std::make_unique<ComplianceEvaluator>(loads, p.section, p.compliance,
                                                         factors.stiffness, factors.mass)),
        energies(compliance->individual(factors.stiffness, factors.mass)) {}
};

/// Designs all bodies in one cycle, up to the group that the observer stops.
class CycleDesigner {
 public:
  CycleDesigner(std::vector<BodyProblem>& problems, const std::vector<fem::EslSets>& loads)
      : problems_(problems), loads_(loads), outcomes_(problems.size()) {}

  /// Designs all bodies. @return false if the observer stopped the run
  bool go(int cycle, const LoopSettings& settings, const LoopObserver& observer) {
    bool is_running = true;
    for (const std::vector<size_t>& group : groups_of(problems_)) {
      design(group, cycle, settings, observer, is_running);
      if (!is_running) break;
    }
    return is_running;
  }

  /// Returns the outcomes of the bodies up to the first one that has none.
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
              const LoopObserver& observer, bool& is_running) {
    std::vector<std::unique_ptr<Start>> starts;
    std::vector<LoadedBody> bodies;
    for (const size_t i : group) {
      starts.push_back(std::make_unique<Start>(problems_[i], loads_[i]));
      bodies.push_back({problems_[i], *starts.back()->compliance});
    }
    std::vector<BodyOutcome> found =
        design_bodies(bodies, cycle, settings.design, observer.iteration, is_running);
    for (size_t k = 0; k < group.size(); ++k) {
      BodyOutcome& outcome = outcomes_[group[k]].emplace(std::move(found[k]));
      const std::vector<fem::EslSet>& sets = loads_[group[k]].sets;
      for (size_t l = 0; l < sets.size(); ++l)
        outcome.energy_ratios.push_back(0.5 * starts[k]->energies[static_cast<Eigen::Index>(l)] /
                                        sets[l].strain_energy);
      outcome.design_change = (outcome.crisp.fractions - starts[k]->fractions).cwiseAbs().sum() /
                              ersatz_of(problems_[group[k]]).n_domain_cells();
    }
  }

  std::vector<BodyProblem>& problems_;
  const std::vector<fem::EslSets>& loads_;
  std::vector<std::optional<BodyOutcome>> outcomes_;
};

std::vector<fem::ScaleFactors> factors_of(const std::vector<BodyProblem>& problems) {
  std::vector<fem::ScaleFactors> out;
  for (const BodyProblem& p : problems) out.push_back(dynamic_factors(p, p.design.components()));
  return out;
}

/// Designs and outcomes of the cycles so far, and the index of the best one.
class Verdicts {
 public:
  void add(int cycle, const std::vector<BodyProblem>& problems,
           const std::vector<BodyOutcome>& outcome) {
    CycleVerdict& v = verdicts_.emplace_back();
    v.cycle = cycle;
    for (size_t k = 0; k < outcome.size(); ++k) {
      const BodyOutcome& o = outcome[k];
      v.objective += o.compliance;
      v.violation = std::max(v.violation, crisp_violation(problems[k], o.crisp));
      v.bodies.push_back({o.body, o.compliance, o.crisp.compliance, o.design_change});
    }
    outcomes_.push_back(outcome);
    auto& designs = designs_.emplace_back();
    for (const BodyProblem& p : problems) designs.push_back(p.design);
  }
  /// Records the measure of the last cycle added.
  /// @param measure  measure of a motion with the designs of this cycle
  void record(double measure) {
    CycleVerdict& last = verdicts_.back();
    last.measure = measure;
    const size_t now = verdicts_.size() - 1;
    if (now > 0 && !better(last, verdicts_[best_])) return;
    verdicts_[best_].best = false;
    best_ = now;
    last.best = true;
  }
  /// Tells whether the last recorded cycle is better than all earlier ones: it has a smaller
  /// violation, or its measure is smaller by more than the fraction `part`.
  bool improved(double part) const {
    if (verdicts_.size() < 2) return true;
    const CycleVerdict& last = verdicts_.back();
    if (!last.best) return false;
    double least = std::numeric_limits<double>::infinity();
    for (size_t k = 0; k + 1 < verdicts_.size(); ++k)
      if (verdicts_[k].violation <= last.violation) least = std::min(least, verdicts_[k].measure);
    return last.measure < (1 - part) * least;
  }
  std::vector<BodyOutcome> take_best(std::vector<BodyProblem>& problems) const {
    for (size_t k = 0; k < problems.size(); ++k) problems[k].design = designs_[best_][k];
    return outcomes_[best_];
  }
  const std::vector<CycleVerdict>& all() const { return verdicts_; }

 private:
  static bool better(const CycleVerdict& a, const CycleVerdict& b) {
    return a.violation == b.violation ? a.measure < b.measure : a.violation < b.violation;
  }

  std::vector<CycleVerdict> verdicts_;
  std::vector<std::vector<BodyOutcome>> outcomes_;
  std::vector<std::vector<Design>> designs_;
  size_t best_ = 0;
};

/// The cycles of a run.
class Loop {
 public:
  Loop(std::vector<BodyProblem>& problems, const Simulate& simulate, const LoopSettings& settings,
       const LoopObserver& observer)
      : problems_(problems), simulate_(simulate), settings_(settings), observer_(observer) {}

  std::vector<BodyOutcome> go() {
    CycleMotion motion = simulate_(factors_of(problems_));
    for (int cycle = 1;; ++cycle) {
      if (observer_.loads) observer_.loads(cycle, motion.loads);
      if (!design(cycle, motion.loads)) return outcome_;
      if (settings_.max_cycles == 1) return outcome_;
      const bool last = cycle == settings_.max_cycles;
      const std::vector<fem::ScaleFactors> factors = factors_of(problems_);
      if (settings_.verification_motion) record(settings_.verification_motion(factors));
      if (settings_.verification_motion && ends(last)) break;
      motion = simulate_(factors);
      if (!settings_.verification_motion) record(motion.measure);
      const bool fits = loads_fit(cycle, motion.loads);
      if (fits && of_use() && verdicts_.improved(settings_.tolerance)) {
        say_end(CyclesEnd::loads_agree);
        break;
      }
      if (ends(last)) break;
    }
    return verdicts_.take_best(problems_);
  }

 private:
  /// Runs the design of a cycle. @return false if the observer stopped the run
  bool design(int cycle, const std::vector<fem::EslSets>& loads) {
    CycleDesigner designer(problems_, loads);
    const bool is_running = designer.go(cycle, settings_, observer_);
    outcome_ = designer.outcomes();
    if (observer_.cycle) observer_.cycle(cycle, outcome_);
    if (is_running) verdicts_.add(cycle, problems_, outcome_);
    return is_running;
  }

  /// Tells whether the measure of the last cycle, or the number of cycles, ends the cycles.
  bool ends(bool last) const {
    const bool improved = verdicts_.improved(settings_.tolerance);
    if (!improved)
      say_end(CyclesEnd::little_improvement);
    else if (last)
      say_end(CyclesEnd::most_cycles);
    return last || !improved;
  }
  void say_end(CyclesEnd reason) const {
    if (observer_.end) observer_.end(reason);
  }

  void record(double measure) {
    verdicts_.record(measure);
    if (observer_.verdict) observer_.verdict(verdicts_.all());
  }

  /// Tells whether the loads of the cycle agree with those of the motion with its designs.
  bool loads_fit(int cycle, const std::vector<fem::EslSets>& own) const {
    std::vector<LoadDifference> all;
    for (size_t k = 0; k < problems_.size(); ++k)
      all.push_back(load_difference(problems_[k], outcome_[k].load_compliances, own[k]));
    if (observer_.difference) observer_.difference(cycle, all);
    return std::all_of(all.begin(), all.end(), [this](const LoadDifference& d) {
      return d.loads < settings_.load_difference;
    });
  }

  /// Tells whether the designs of the last cycle are at least as stiff as uniform material. If not,
  /// another cycle follows even if the loads agree.
  bool of_use() const {
    for (size_t k = 0; k < problems_.size(); ++k)
      if (worse_than_uniform(problems_[k], outcome_[k])) return false;
    return true;
  }

  std::vector<BodyProblem>& problems_;
  const Simulate& simulate_;
  const LoopSettings& settings_;
  const LoopObserver& observer_;
  Verdicts verdicts_;
  std::vector<BodyOutcome> outcome_;
};

}  // namespace

std::vector<BodyOutcome> esl_loop(std::vector<BodyProblem>& problems, const Simulate& simulate,
                                  const LoopSettings& settings, const LoopObserver& observer) {
  return Loop(problems, simulate, settings, observer).go();
}

}  // namespace flexmorph::mmc
