#include "cases/run/design_run.h"

#include "cases/results/warnings.h"
#include "cases/run/corrections.h"
#include "cases/run/motions.h"
#include "cases/run/outline_verification.h"
#include "geometry/cpu_time.h"
#include "io/files.h"

namespace flexmorph::cases {

/// The evaluations of designs, which are stored in the run folder until the run is complete.
/// Without a folder nothing is stored.
class KeptEvaluations {
 public:
  explicit KeptEvaluations(RunFolder* folder) {
    if (folder == nullptr) return;
    log_.emplace(folder->file(kEvaluations));
    past_.emplace(
        mmc::Past{*log_, [folder](const mmc::RowOfHistory& row) { return folder->has_row(row); }});
  }

  mmc::Past* past() { return past_ ? &*past_ : nullptr; }
  /// Returns ", 35 state solves were restored from the earlier run"; empty in a run that was not
  /// resumed.
  std::string words() const {
    return counted(static_cast<size_t>(log_ ? log_->n_known() : 0),
                   "state solve was restored from the earlier run",
                   "state solves were restored from the earlier run");
  }

 private:
  std::optional<optim::EvaluationLog> log_;
  std::optional<mmc::Past> past_;
};

namespace {

std::string summary(const mmc::BodyOutcome& o) {
  return o.body + ": compliance " + io::to_text(o.compliance, 5) +
         " J; crisp geometry: compliance " + io::to_text(o.crisp.compliance, 5) +
         " J, volume fraction " + io::to_text(o.crisp.volume, 4) +
         "; uniform material: compliance " + io::to_text(o.uniform_compliance, 5) + " J";
}

std::string measure_text(const Cycle& cycle, double value) {
  if (cycle.compare_by == CycleMeasure::strain_energy)
    return "the time integral of the strain energy is " + io::to_text(value, 5) + " J s";
  const char* what = cycle.compare_by == CycleMeasure::rms            ? "root mean square"
                     : cycle.compare_by == CycleMeasure::peak_to_peak ? "peak-to-peak value"
                                                                      : "absolute mean value";
  return std::string("the ") + what + " of the deflection of '" + cycle.compare_point + "' is " +
         io::to_text(value, 5) + " m";
}

/// Returns two sentences with the two numbers of a load difference, see mmc::LoadDifference.
std::string difference_text(const mmc::LoadDifference& d) {
  return "The loads for the design of '" + d.body + "' differ from the loads of its motion by " +
         io::to_text(100 * d.loads, 2) +
         " % of the strain energy. The static strain energy differs from the strain energy of the "
         "motion by " +
         io::to_text(100 * d.geometric, 2) + " % (large deflections or coarse elements).";
}

std::string verdict_text(const Cycle& cycle, const mmc::CycleVerdict& v) {
  return "cycle " + std::to_string(v.cycle) + ": The sum of the compliances is " +
         io::to_text(v.objective, 5) + " J, " + measure_text(cycle, v.measure) + "." +
         (v.violation > 0 ? " The designs violate limits." : "") +
         (v.best ? " This cycle is the best one so far."
                 : " This cycle is not better than the earlier cycles.");
}

/// Returns a sentence with the reason for which the cycles end.
std::string end_text(const Cycle& cycle, mmc::CyclesEnd reason) {
  switch (reason) {
    case mmc::CyclesEnd::loads_agree:
      return "The cycles end, because the loads of every design agree with those of its motion "
             "within cycle.load_difference = " +
             io::to_text(cycle.load_difference, 3) + ".";
    case mmc::CyclesEnd::little_improvement:
      return "The cycles end, because the last cycle is not better by more than the fraction "
             "cycle.tolerance = " +
             io::to_text(cycle.tolerance, 3) + ".";
    case mmc::CyclesEnd::most_cycles:
      return "The cycles end, because cycle.max_cycles = " + std::to_string(cycle.max_cycles) +
             " is reached.";
  }
  return "";
}

mmc::DesignSettings settings_of(const RunContext& run, KeptEvaluations& kept) {
  const Scene& scene = run.scene();
  return {scene.output.crisp_every, scene.optimizer, run.condition, kept.past(), run.keep_running};
}

/// Returns an observer that writes every iteration, passes it to the callback, and displays it.
mmc::IterationObserver iteration_observer(const RunContext& run) {
  return [&run](const mmc::IterationReport& r) {
    if (run.folder) run.folder->add_iteration(r);
    if (run.iteration) run.iteration(r);
    run.progress.iteration(r);
    return run.keep_running();
  };
}

}  // namespace

void DesignRun::run() {
  design_.problems = run_.prepared.design_problems();
  if (run_.folder)
    for (const mmc::BodyProblem& problem : design_.problems) run_.folder->write_start(problem);
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
    motions_ = {};  // the motions belong to the design before the correction
  }
  verify_outlines(loads);
  const double begin = cpu_seconds();
  compare_loads(assess_by_motion(run_, design_.problems, loads, motions_));
  design_.seconds_verification = cpu_seconds() - begin;
  if (scene.certify)
    design_.certificate = certify_by_motion(run_, *scene.certify, loads, design_.problems);
}

void DesignRun::compare_loads(std::span<const fem::EslSets> own) {
  for (size_t i = 0; i < own.size(); ++i)
    design_.load_differences.push_back(
        mmc::load_difference(design_.problems[i], design_.outcomes[i].load_compliances, own[i]));
}

/// The loads of the current cycle and of the best cycle so far.
struct DesignRun::CycleLoads {
  std::vector<fem::EslSets>& now;
  std::vector<fem::EslSets> best;
};

mmc::LoopObserver DesignRun::cycle_observer(CycleMotions& motions, const KeptEvaluations& kept,
                                            CycleLoads& loads) {
  mmc::LoopObserver observer;
  observer.loads = [&](int, std::span<const fem::EslSets> sets) {
    run_.progress.begin("design");
    loads.now.assign(sets.begin(), sets.end());
    if (run_.folder)
      for (size_t i = 0; i < sets.size(); ++i)
        run_.folder->write_loads(run_.scene().designs[i].body, sets[i], nullptr);
  };
  observer.iteration = iteration_observer(run_);
  observer.cycle = [&](int cycle, std::span<const mmc::BodyOutcome> outcomes) {
    design_.cycles = cycle;
    design_.outcomes.assign(outcomes.begin(), outcomes.end());
    run_.progress.begin("files of the parts");
    for (size_t i = 0; i < outcomes.size(); ++i) {
      add_unloaded_seconds(outcomes[i]);
      if (run_.folder) {
        run_.folder->write_loads(outcomes[i].body, loads.now[i], &outcomes[i]);
        run_.folder->write_design(design_.problems[i], outcomes[i]);
      }
      run_.progress.say(summary(outcomes[i]) + kept.words());
    }
  };
  observer.verdict = [&](std::span<const mmc::CycleVerdict> verdicts) {
    design_.verdicts.assign(verdicts.begin(), verdicts.end());
    if (run_.folder) run_.folder->write_cycles(verdicts, {});
    if (verdicts.back().best) {
      loads.best = loads.now;  // the next cycle replaces loads.now
      motions.keep_assessed();
    }
    run_.progress.say(verdict_text(run_.scene().cycle, verdicts.back()));
  };
  observer.difference = [this](int cycle, std::span<const mmc::LoadDifference> all) {
    for (const mmc::LoadDifference& d : all)
      run_.progress.say("cycle " + std::to_string(cycle) + ": " + difference_text(d));
  };
  observer.end = [this](mmc::CyclesEnd reason) {
    design_.cycles_end = end_text(run_.scene().cycle, reason);
    run_.progress.say(design_.cycles_end);
  };
  return observer;
}

void DesignRun::add_unloaded_seconds(const mmc::BodyOutcome& outcome) {
  if (outcome.length_scale) design_.seconds_unloaded += outcome.length_scale->seconds;
}

void DesignRun::run_cycles(std::vector<fem::EslSets>& loads) {
  const Scene& scene = run_.scene();
  CycleMotions motions(run_);
  KeptEvaluations kept(run_.folder);
  CycleLoads cycle_loads{loads, {}};
  const mmc::LoopObserver observer = cycle_observer(motions, kept, cycle_loads);
  const bool analysed = scene.optimizer.max_iterations == 0;
  const mmc::LoopSettings settings{analysed ? 1 : scene.cycle.max_cycles, scene.cycle.tolerance,
                                   scene.cycle.load_difference, settings_of(run_, kept),
                                   motions.verify()};
  // Results of completed motions are stored even if a cycle fails.
  const auto keep = [&] {
    design_.seconds_motion = motions.seconds();
    motions_ = motions.take_results();
  };
  std::vector<mmc::BodyOutcome> best;
  try {
    best = mmc::esl_loop(
        design_.problems,
        [&](std::span<const fem::ScaleFactors> factors) { return motions.loads(factors); },
        settings, observer);
  } catch (...) {
    keep();
    throw;
  }
  keep();
  if (!run_.keep_running()) throw Interrupted();
  if (design_.verdicts.empty()) return;
  design_.outcomes = best;
  loads = std::move(cycle_loads.best);
  if (!run_.folder) return;
  run_.progress.begin("files of the best designs");
  for (size_t i = 0; i < best.size(); ++i) run_.folder->write_design(design_.problems[i], best[i]);
}

void DesignRun::design_at_rest() {
  const Scene& scene = run_.scene();
  mmc::BodyProblem& problem = design_.problems.front();
  const std::unique_ptr<mmc::ComplianceEvaluator> loads = build_static_loads(scene, problem);
  KeptEvaluations kept(run_.folder);
  bool is_running = true;
  run_.progress.begin("design");
  const mmc::BodyOutcome outcome = mmc::design_body(problem, *loads, 1, settings_of(run_, kept),
                                                    iteration_observer(run_), is_running);
  design_.cycles = 1;
  design_.outcomes = {outcome};
  add_unloaded_seconds(outcome);
  const auto write_loads = [&](const VerifiedOutline* outline) {
    std::vector<StaticLoad> found =
        static_loads_of(*scene.domain, problem, *loads, outcome, outline);
    // The displacements of the cells are those of the first call, without the outline.
    for (size_t l = 0; l < design_.static_loads.size(); ++l)
      found[l].displacement = std::move(design_.static_loads[l].displacement);
    design_.static_loads = std::move(found);
    if (run_.folder) run_.folder->write_static_loads(*scene.domain, design_.static_loads);
  };
  write_loads(nullptr);
  run_.progress.begin("files of the parts");
  if (run_.folder) run_.folder->write_design(problem, outcome);
  run_.progress.say(summary(outcome) + kept.words());
  if (!run_.keep_running()) throw Interrupted();
  verify_outlines({});
  write_loads(&design_.outlines.front());
}

void DesignRun::verify_outlines(std::span<const fem::EslSets> loads) {
  run_.progress.begin("verification of outlines");
  for (size_t i = 0; i < design_.outcomes.size(); ++i) {
    VerifiedOutline found =
        verify_outline_of(run_.scene(), design_.problems[i], loads.empty() ? nullptr : &loads[i],
                          run_.keep_running, run_.folder);
    if (!run_.keep_running()) throw Interrupted();  // the verification is incomplete
    design_.outlines.push_back(std::move(found));
    run_.progress.say(outline_text(design_.outlines.back(), design_.outcomes[i].crisp.compliance));
  }
}

}  // namespace flexmorph::cases
