#include "cases/run/design_run.h"

#include "cases/results/warnings.h"
#include "cases/run/corrections.h"
#include "cases/run/motions.h"
#include "cases/run/outline_verification.h"
#include "geometry/cpu_time.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

std::string summary(const mmc::BodyOutcome& o) {
  return o.body + ": compliance " + io::to_text(o.compliance, 5) + ", sharp " +
         io::to_text(o.sharp.compliance, 5) + " at volume " + io::to_text(o.sharp.volume, 4) +
         ", uniform material " + io::to_text(o.uniform_compliance, 5);
}

std::string verdict_words(const mmc::CycleVerdict& v) {
  return "cycle " + std::to_string(v.cycle) + ": compliance of all bodies " +
         io::to_text(v.objective, 5) + ", strain energy over time " +
         io::to_text(v.strain_energy_integral, 5) + " J s" +
         (v.best ? ", the least so far" : ", no less than before: the last one");
}

/// The evaluations of designs, kept in the folder while the run is not done.
class KeptEvaluations {
 public:
  explicit KeptEvaluations(RunFolder& folder)
      : log_(folder.file(kEvaluations)), past_{log_, [&folder](const mmc::RowOfHistory& row) {
                                                 return folder.has_row(row);
                                               }} {}

  mmc::Past* past() { return &past_; }
  /// ", 35 state solves were known"; empty in a run that began anew.
  std::string words() const {
    return counted(static_cast<size_t>(log_.n_known()), "state solve was known",
                   "state solves were known");
  }

 private:
  optim::EvaluationLog log_;
  mmc::Past past_;
};

mmc::DesignSettings settings_of(const RunContext& run, KeptEvaluations& kept) {
  const Scene& scene = run.scene();
  return {scene.output.sharp_every,
          scene.optimizer,
          run.condition,
          kept.past(),
          scene.finish,
          run.go_on};
}

/// Writes every iteration and shows it.
mmc::IterationObserver iteration_observer(const RunContext& run) {
  return [&run, most = run.prepared.extent().iterations](const mmc::IterationReport& r) {
    run.folder.add_iteration(r);
    run.progress.iteration(r, most);
    return run.go_on();
  };
}

}  // namespace

void DesignRun::run() {
  design_.problems = run_.prepared.design_problems();
  for (const mmc::BodyProblem& problem : design_.problems) run_.folder.write_start(problem);
  if (run_.scene().domain)
    design_at_rest();
  else
    design_moving();
}

void DesignRun::design_moving() {
  const Scene& scene = run_.scene();
  std::vector<fem::EslSets> loads;
  run_cycles(loads);
  if (scene.cycle.correction.kind != mmc::Correction::none) {
    correct_by_motion(run_, loads, design_);
    motions_ = {};  // they are those of the design before
  }
  verify_outlines(loads);
  const double begin = cpu_seconds();
  design_.energies = compared_energies(design_.problems,
                                       assess_by_motion(run_, design_.problems, loads, motions_));
  design_.seconds_verification = cpu_seconds() - begin;
  if (scene.certify)
    design_.certificate = certify_by_motion(run_, *scene.certify, loads, design_.problems);
}

void DesignRun::run_cycles(std::vector<fem::EslSets>& loads) {
  const Scene& scene = run_.scene();
  CycleMotions motions(run_);
  KeptEvaluations kept(run_.folder);
  std::vector<fem::EslSets> best_loads;
  mmc::LoopObserver observer;
  observer.loads = [&](int, std::span<const fem::EslSets> sets) {
    loads.assign(sets.begin(), sets.end());
    for (size_t i = 0; i < sets.size(); ++i)
      run_.folder.write_loads(scene.designs[i].body, sets[i], nullptr);
  };
  observer.iteration = iteration_observer(run_);
  observer.cycle = [&](int cycle, std::span<const mmc::BodyOutcome> outcomes) {
    design_.cycles = cycle;
    design_.outcomes.assign(outcomes.begin(), outcomes.end());
    for (size_t i = 0; i < outcomes.size(); ++i) {
      design_.seconds_clean_up += outcomes[i].seconds_mending;
      run_.folder.write_loads(outcomes[i].body, loads[i], &outcomes[i]);
      run_.folder.write_design(design_.problems[i], outcomes[i]);
      run_.progress.say(summary(outcomes[i]) + kept.words());
    }
  };
  observer.verdict = [&](std::span<const mmc::CycleVerdict> verdicts) {
    design_.verdicts.assign(verdicts.begin(), verdicts.end());
    run_.folder.write_cycles(verdicts, {});
    if (verdicts.back().best) {
      best_loads = loads;  // the next cycle has others
      motions.keep_assessed();
    }
    run_.progress.say(verdict_words(verdicts.back()));
  };
  const bool analysed = scene.optimizer.max_iterations == 0;
  const mmc::LoopSettings settings{analysed ? 1 : scene.cycle.max_cycles, scene.cycle.tolerance,
                                   settings_of(run_, kept), motions.judge()};
  // What was computed is kept also when a cycle fails.
  const auto keep = [&] {
    design_.seconds_motion = motions.seconds();
    motions_ = motions.take_results();
  };
  std::vector<mmc::BodyOutcome> best;
  try {
    best = mmc::esl_loop(
        design_.problems,
        [&](std::span<const fem::Factors> factors) { return motions.loads(factors); }, settings,
        observer);
  } catch (...) {
    keep();
    throw;
  }
  keep();
  if (!run_.go_on()) throw Interrupted();
  if (design_.verdicts.empty()) return;
  design_.outcomes = best;
  loads = std::move(best_loads);
  for (size_t i = 0; i < best.size(); ++i) run_.folder.write_design(design_.problems[i], best[i]);
}

void DesignRun::design_at_rest() {
  const Scene& scene = run_.scene();
  mmc::BodyProblem& problem = design_.problems.front();
  const std::unique_ptr<mmc::ComplianceEvaluator> loads = build_static_loads(scene, problem);
  KeptEvaluations kept(run_.folder);
  bool going = true;
  run_.progress.begin("design");
  const mmc::BodyOutcome outcome = mmc::design_body(problem, *loads, 1, settings_of(run_, kept),
                                                    iteration_observer(run_), going);
  design_.cycles = 1;
  design_.outcomes = {outcome};
  design_.seconds_clean_up = outcome.seconds_mending;
  const auto write_loads = [&](const VerifiedOutline* outline) {
    design_.static_loads = static_loads_of(*scene.domain, problem, *loads, outcome, outline);
    run_.folder.write_static_loads(*scene.domain, design_.static_loads);
  };
  write_loads(nullptr);
  run_.folder.write_design(problem, outcome);
  run_.progress.say(summary(outcome) + kept.words());
  if (!run_.go_on()) throw Interrupted();
  verify_outlines({});
  write_loads(&design_.outlines.front());
}

void DesignRun::verify_outlines(std::span<const fem::EslSets> loads) {
  run_.progress.begin("judge");
  for (size_t i = 0; i < design_.outcomes.size(); ++i) {
    VerifiedOutline found =
        verify_outline_of(run_.scene(), design_.problems[i], loads.empty() ? nullptr : &loads[i],
                          run_.go_on, run_.folder);
    if (!run_.go_on()) throw Interrupted();  // it was not done to the end
    design_.outlines.push_back(std::move(found));
    run_.progress.say(outline_words(design_.outlines.back(), design_.outcomes[i].sharp.compliance));
  }
}

}  // namespace flexmorph::cases
