#include "cases/run/run.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <new>
#include <nlohmann/json.hpp>

#include "cases/assembly/resource_estimate.h"
#include "cases/assembly/twin.h"
#include "cases/output/kept_case.h"
#include "cases/output/paraview_script.h"
#include "cases/output/report.h"
#include "cases/results/expectations.h"
#include "cases/results/warnings.h"
#include "cases/run/corrections.h"
#include "cases/run/motions.h"
#include "cases/run/path_run.h"
#include "cases/run/progress.h"
#include "cases/scene/version.h"
#include "geometry/cpu_time.h"
#include "io/case_document.h"
#include "io/case_parser.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

std::atomic<bool> interrupted = false;  // set by a signal, read by every motion

bool go_on() { return !interrupted; }

std::string summary(const mmc::BodyOutcome& o) {
  return o.body + ": compliance " + io::to_text(o.compliance, 5) + ", sharp " +
         io::to_text(o.sharp.compliance, 5) + " at volume " + io::to_text(o.sharp.volume, 4) +
         ", uniform material " + io::to_text(o.uniform_compliance, 5);
}

/// What the outlines of the final designs say.
/// @param loads  of the motion, of each body; none: a plate at rest
void judge_outlines(const Scene& scene, std::span<const fem::EslSets> loads, RunFolder& folder,
                    Progress& progress, RunReport& report) {
  progress.begin("judge");
  for (size_t i = 0; i < report.outcomes.size(); ++i) {
    JudgedBody judged =
        judge_body(scene, report.problems[i], loads.empty() ? nullptr : &loads[i], go_on, folder);
    if (interrupted) throw Interrupted();  // no verdict: it was not done
    report.judged.push_back(std::move(judged));
    progress.say(judged_words(report.judged.back(), report.outcomes[i].sharp.compliance));
  }
}

const char* const kEvaluations = "evaluations.log";

/// Evaluations of a design, kept in the folder while the run is not done.
class Memory {
 public:
  explicit Memory(RunFolder& folder)
      : log_(folder.file(kEvaluations)), past_{log_, [&folder](const mmc::RowOfHistory& row) {
                                                 return folder.has_row(row);
                                               }} {}

  mmc::Past* past() { return &past_; }
  /// ", 35 state solves were known"; nothing in a run that began anew.
  std::string words() const {
    return counted(static_cast<size_t>(log_.n_known()), "state solve was known",
                   "state solves were known");
  }

 private:
  optim::EvaluationLog log_;
  mmc::Past past_;
};

/// The story of a run with designs; fills the report as far as it gets.
void run_designs(const Scene& scene, bool condition, RunFolder& folder, Progress& progress,
                 RunReport& report) {
  report.problems = build_problems(scene);
  for (const mmc::BodyProblem& problem : report.problems) folder.write_start(problem);
  const double most = extent_of(scene).iterations;
  const bool analysed = scene.optimizer.max_iterations == 0;
  CycleMotions motions(scene, condition, go_on, folder, progress, report);
  Memory memory(folder);
  std::vector<fem::EslSets> loads, best_loads;
  mmc::LoopObserver observer;
  observer.loads = [&](int, std::span<const fem::EslSets> sets) {
    loads.assign(sets.begin(), sets.end());
    for (size_t i = 0; i < sets.size(); ++i)
      folder.write_loads(scene.designs[i].body, sets[i], nullptr);
  };
  observer.iteration = [&](const mmc::IterationReport& r) {
    folder.add_iteration(r);
    progress.iteration(r, most);
    return go_on();
  };
  observer.cycle = [&](int cycle, std::span<const mmc::BodyOutcome> outcomes) {
    report.cycles = cycle;
    report.outcomes.assign(outcomes.begin(), outcomes.end());
    for (const mmc::BodyOutcome& o : outcomes) report.seconds_mending += o.seconds_mending;
    for (size_t i = 0; i < outcomes.size(); ++i) {
      folder.write_loads(outcomes[i].body, loads[i], &outcomes[i]);
      folder.write_design(report.problems[i], outcomes[i]);
      progress.say(summary(outcomes[i]) + memory.words());
    }
  };
  mmc::LoopSettings settings{
      analysed ? 1 : scene.cycle.max_cycles,
      scene.cycle.tolerance,
      {scene.output.sharp_every, scene.optimizer, condition, memory.past(), scene.finish, go_on},
      motions.judge()};
  observer.verdict = [&](std::span<const mmc::CycleVerdict> verdicts) {
    report.verdicts.assign(verdicts.begin(), verdicts.end());
    folder.write_cycles(verdicts, {});
    const mmc::CycleVerdict& v = verdicts.back();
    if (v.best) {
      best_loads = loads;  // the next cycle has others
      motions.keep_judged();
    }
    progress.say("cycle " + std::to_string(v.cycle) + ": compliance of all bodies " +
                 io::to_text(v.objective, 5) + ", strain energy over time " +
                 io::to_text(v.strain_energy_integral, 5) + " J s" +
                 (v.best ? ", the least so far" : ", no less than before: the last one"));
  };
  const std::vector<mmc::BodyOutcome> best = mmc::esl_loop(
      report.problems,
      [&](std::span<const fem::Factors> factors) { return motions.loads(factors); }, settings,
      observer);
  if (interrupted) throw Interrupted();
  if (!report.verdicts.empty()) {
    report.outcomes = best;
    loads = std::move(best_loads);
    for (size_t i = 0; i < best.size(); ++i) folder.write_design(report.problems[i], best[i]);
  }

  const bool corrected = scene.cycle.correction.kind != mmc::Correction::none;
  if (corrected) {
    correct_by_motion(scene, go_on, loads, folder, progress, report);
    report.verified.reset();  // of the design before
  }
  const bool is_new = !analysed || corrected;
  if (is_new) judge_outlines(scene, loads, folder, progress, report);
  if (analysed && !corrected) report.energies = compared_energies(report.problems, loads);
  const double begin = cpu_seconds();
  if (is_new) judge_by_motion(scene, condition, go_on, folder, progress, report);
  report.seconds_verification = cpu_seconds() - begin;
  if (scene.certify)
    certify_by_motion(scene, *scene.certify, loads, go_on, folder, progress, report);
}

/// The story of a plate at rest.
void run_static(const Scene& scene, bool condition, RunFolder& folder, Progress& progress,
                RunReport& report) {
  report.problems = build_problems(scene);
  for (const mmc::BodyProblem& problem : report.problems) folder.write_start(problem);
  mmc::BodyProblem& problem = report.problems.front();
  const std::unique_ptr<mmc::ComplianceEvaluator> loads = build_static_loads(scene, problem);
  Memory memory(folder);
  bool going = true;
  const double most = extent_of(scene).iterations;
  progress.begin("design");
  const mmc::IterationObserver observe = [&](const mmc::IterationReport& r) {
    folder.add_iteration(r);
    progress.iteration(r, most);
    return go_on();
  };
  const mmc::BodyOutcome outcome = mmc::design_body(
      problem, *loads, 1,
      {scene.output.sharp_every, scene.optimizer, condition, memory.past(), scene.finish, go_on},
      observe, going);
  report.cycles = 1;
  report.outcomes = {outcome};
  report.seconds_mending = outcome.seconds_mending;
  folder.write_static_loads(*scene.domain, outcome);
  folder.write_design(problem, outcome);
  progress.say(summary(outcome) + memory.words());
  if (interrupted) throw Interrupted();
  if (scene.optimizer.max_iterations > 0) judge_outlines(scene, {}, folder, progress, report);
}

/// The run itself.
void tell_story(const Scene& scene, bool condition, RunFolder& folder, Progress& progress,
                RunReport& report) {
  if (scene.domain) return run_static(scene, condition, folder, progress, report);
  if (!scene.designs.empty()) return run_designs(scene, condition, folder, progress, report);
  if (scene.statics) {
    progress.begin("statics");
    const double to = scene.statics->to;
    const auto way = [&](double factor) {
      progress.way("statics", std::clamp(factor / to, 0.0, 1.0),
                   "load factor " + io::to_text(factor, 4) + " of " + io::to_text(to, 4));
    };
    report.path = run_path(scene, folder, {.condition = condition, .go_on = go_on, .way = way});
    const fem::StaticResult& result = report.path->result;
    progress.say("statics: load factor " + io::to_text(result.factor, 5) + " after " +
                 std::to_string(result.steps) + " steps, " + std::to_string(result.iterations) +
                 " Newton iterations");
    return;
  }
  MotionWishes wishes;
  wishes.frames_every = scene.output.vtk ? scene.output.motion_every : 0;
  wishes.moments = moments_of(scene);
  wishes.condition = condition;
  wishes.go_on = go_on;
  wishes.say = [&](const std::string& words) { progress.say(words); };
  wishes.way = way_of(progress, scene, wishes.phase);
  keep_going(wishes, report, progress, wishes.table);
  progress.begin(wishes.phase);
  report.motion = run_motion(scene, wishes, folder).record;
  const fem::MotionResult& result = report.motion->result;
  progress.say("motion: " + std::to_string(result.counts.steps) + " steps, " +
               std::to_string(result.counts.newton) + " Newton iterations, " +
               std::to_string(result.events.size()) + " changes of the mesh");
}

/// @throws Error (numerical) also where memory runs out: the estimate of room.h is within a factor.
void run_scene(const Scene& scene, bool condition, RunFolder& folder, Progress& progress,
               RunReport& report) {
  try {
    tell_story(scene, condition, folder, progress, report);
    folder.finish();
    report.lost_frames = folder.lost_frames();
    report.missing_exports = folder.missing_exports();
  } catch (const std::bad_alloc&) {
    throw Error::numerical(out_of_memory_words(extent_of(scene)));
  }
}

}  // namespace

/// Signals that end a run: it ends its step or iteration and writes what it has; a second one stops
/// at once. Nobody who listened to the output and left ends it.
void end_on_signals() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP})
    std::signal(signal, [](int number) {
      if (!interrupted.exchange(true)) return;
      std::signal(number, SIG_DFL);
      std::raise(number);
    });
  std::signal(SIGPIPE, SIG_IGN);
}

/// Do these options make another case, of which [expect] does not speak?
bool is_another_case(std::span<const std::string> overrides) {
  return std::any_of(overrides.begin(), overrides.end(), [](const std::string& each) {
    return !each.starts_with("output.") && !each.starts_with("expect");
  });
}

/// The exit code of the run in a folder that came to its end; nothing where there is something left
/// to resume.
/// @throws Error (input) when the run in the folder is that of another case.
std::optional<int> finished_with(const std::string& directory, const RunOptions& options,
                                 const io::CaseFile& file) {
  const std::string path = directory + "/run.json";
  if (!std::filesystem::exists(path)) return {};
  if (!keeps_case(directory, file))
    throw Error::input("'" + directory +
                       "' holds a run of another case, or of this one before it "
                       "was changed: it cannot be resumed; without --resume it is moved");
  const nlohmann::json run = nlohmann::json::parse(io::read_text(path));
  const std::string status = run.value("status", "");
  if (!status.starts_with("done")) return {};
  bool missed = status != "done";  // of no use
  const nlohmann::json expect = run.value("expect", nlohmann::json::object());
  for (const auto& [name, expected] : expect.items())
    missed = missed || (!is_another_case(options.overrides) && !expected.value("holds", true));
  return missed ? kMissed : 0;
}

/// Removes what only resuming needs, of a run whose results are all written: until then a run that
/// is killed can be resumed.
void forget_progress(const FilesOf& files_of) {
  std::error_code none;
  for (const std::string& path : files_of(kEvaluations)) std::filesystem::remove(path, none);
  forget_motions(files_of);
}

/// Does that for a run that was killed as soon as it was done.
void forget_progress_of_finished(const std::string& directory) {
  try {
    io::OutputFolder folder(directory, io::OutputFolder::Begin::go_on);
    forget_progress([&](const std::string& ending) { return folder.files_of(ending); });
  } catch (const Error&) {  // taken, or not to be written: the files harm nobody
  }
}

int run_case(const RunOptions& options) {
  const auto wall = std::chrono::steady_clock::now();
  // What cannot be built, or is too large, is refused before a folder exists.
  const auto [file, scene] =
      ready_case(options.case_name, options.overrides, options.directory, options.threads);
  std::string directory = options.directory;
  if (directory.empty()) directory = scene.output.directory;
  if (directory.empty()) directory = "runs/" + scene.name;
  if (options.resume)
    if (const std::optional<int> code = finished_with(directory, options, file)) {
      forget_progress_of_finished(directory);
      std::printf("%s: finished before\n", directory.c_str());
      return *code;
    }
  RunFolder folder(directory, scene, options.threads > 1,
                   options.resume ? RunFolder::Begin::go_on : RunFolder::Begin::anew);
  keep_case(file, options.explain, folder);
  if (scene.output.vtk) folder.write_text("paraview.py", kParaViewScript);
  end_on_signals();
  Progress progress(options.quiet);
  progress.say(scene.title + " -> " + directory);
  if (options.resume && scene.statics)
    progress.say("a path of equilibria is not resumed: it starts anew");
  if (!folder.moved_to().empty())
    progress.say("the run that was there is now " + folder.moved_to());
  RunReport report;
  report.threads = options.threads;
  report.resumed = options.resume;
  const auto close = [&](const std::string& status, const std::string& message) {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    report.status = status;
    report.message = message;
    report.seconds_cpu = cpu_seconds();
    report.seconds_wall =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - wall).count();
    report.peak_memory_bytes = 1024.0 * static_cast<double>(usage.ru_maxrss);
    report.phases = phases_of(report, folder);
    write_report(scene, report, folder);
  };
  close("running", "");
  try {
    run_scene(scene, options.condition, folder, progress, report);
  } catch (const Interrupted&) {
    close("interrupted", "");
    progress.say("interrupted: what was computed is in " + directory);
    return 4;
  } catch (const std::exception& error) {
    report.failure = failure_of(error, progress.where());
    try {
      close("failed", error.what());
    } catch (const std::exception&) {  // on a full disk the first failure is the one to tell
    }
    throw;
  }
  const std::vector<Warning> warnings = warnings_of(scene, report);
  try {
    close(done_words(warnings), "");
  } catch (const Error& error) {
    // The results are whole, a page or a picture of them is not.
    report.failure = failure_of(error, progress.where());
    try {
      close("failed", error.what());
    } catch (const Error&) {  // likewise
    }
    throw;
  }
  forget_progress([&](const std::string& ending) { return folder.files_of(ending); });
  for (const Warning& each : warnings)
    progress.object(each.unusable ? "not usable" : "warning", each.words);
  size_t missed = 0;
  const bool changed = is_another_case(options.overrides);
  for (const Expected& expected : judge_expectations(scene, report)) {
    if (expected.holds) continue;
    missed += !changed;
    progress.object(changed ? "not as the case without --set" : "missed", expected.words);
  }
  progress.say(report.status + counted(warnings.size(), "warning", "warnings") +
               counted(missed, "expectation missed", "expectations missed") + ": " + directory +
               "/report.html");
  return missed > 0 || !usable(warnings) ? kMissed : 0;
}

}  // namespace flexmorph::cases
