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
#include <exception>
#include <filesystem>
#include <new>
#include <nlohmann/json.hpp>

#include "cases/assembly/resource_estimate.h"
#include "cases/check/ready.h"
#include "cases/output/kept_case.h"
#include "cases/output/paraview_script.h"
#include "cases/output/report.h"
#include "cases/results/expectations.h"
#include "cases/results/summary.h"
#include "cases/results/warnings.h"
#include "cases/run/design_run.h"
#include "cases/run/motions.h"
#include "cases/run/path_run.h"
#include "geometry/cpu_time.h"
#include "io/case_document.h"
#include "io/case_parser.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

using Clock = std::chrono::steady_clock;

std::atomic<bool> interrupted = false;  // set by a signal, read by every motion

PathRecord run_statics(const RunContext& run) {
  const double to = run.scene().statics->to;
  run.progress.begin("statics");
  PathRequest request;
  request.condition = run.condition;
  request.go_on = run.go_on;
  request.reached = [&](double factor) {
    run.progress.way("statics", std::clamp(factor / to, 0.0, 1.0),
                     "load factor " + io::to_text(factor, 4) + " of " + io::to_text(to, 4));
  };
  PathRecord out = run_path(run.prepared, run.folder, request);
  run.progress.say("statics: load factor " + io::to_text(out.result.factor, 5) + " after " +
                   std::to_string(out.result.steps) + " steps, " +
                   std::to_string(out.result.iterations) + " Newton iterations");
  return out;
}

MotionRecord run_only_motion(const RunContext& run) {
  MotionRequest request = result_request(run, "motion");
  request.say = [&](const std::string& words) { run.progress.say(words); };
  run.progress.begin(request.phase);
  MotionRecord out = run_motion(run.prepared, request, run.folder).record;
  const fem::MotionResult& result = out.result;
  run.progress.say("motion: " + std::to_string(result.counts.steps) + " steps, " +
                   std::to_string(result.counts.newton) + " Newton iterations, " +
                   mesh_words(run.prepared.scene(), result));
  return out;
}

/// CPU seconds of the phases of a run with designs: iterations, outlines of final designs, their
/// post-processing and verification, motions; empty without designs.
Seconds phases_of(const DesignResult& design, const RunFolder& folder) {
  Seconds out = folder.phases();
  if (out.empty()) return out;
  for (auto& [name, seconds] : out)
    if (name == "outlines")
      for (const mmc::BodyOutcome& o : design.outcomes) seconds += o.sharp.seconds_outlines;
  double outlines = 0;
  for (const VerifiedOutline& v : design.outlines) outlines += v.seconds;
  out.emplace_back("idle_components", design.seconds_idle);
  out.emplace_back("motion", design.seconds_motion);
  out.emplace_back("judge", outlines);
  out.emplace_back("verification", design.seconds_verification);
  return out;
}

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
void remove_progress(const FilesOf& files_of) {
  std::error_code none;
  for (const std::string& path : files_of(kEvaluations)) std::filesystem::remove(path, none);
  remove_checkpoints(files_of);
}

/// Does that for a run that was killed as soon as it was done.
void remove_progress_of_finished(const std::string& directory) {
  try {
    io::OutputFolder folder(directory, io::OutputFolder::Begin::go_on);
    remove_progress([&](const std::string& ending) { return folder.files_of(ending); });
  } catch (const Error&) {  // taken, or not to be written: the files harm nobody
  }
}

/// Writes what is in the folder of a run: its case at the start, its results at the end.
class RunFiles {
 public:
  /// @param begin  time at which the program began with the run
  RunFiles(const Scene& scene, RunFolder& folder, int threads, Clock::time_point begin)
      : scene_(scene), folder_(folder), threads_(threads), begin_(begin) {}

  /// Completes a result and writes it with its report.
  /// @param status  "done" becomes "done, not usable" where a warning says so
  /// @return the result as it was written
  RunResult write(RunResult result, const std::string& status, const std::string& message) {
    result.warnings = warnings_of(scene_, result);
    result.expectations = compare_expectations(scene_, result);
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    RunInfo& info = result.info;
    info.status = status == "done" ? done_words(result.warnings) : status;
    info.message = message;
    info.threads = threads_;
    info.seconds_cpu = cpu_seconds();
    info.seconds_wall = std::chrono::duration<double>(Clock::now() - begin_).count();
    info.peak_memory_bytes = 1024.0 * static_cast<double>(usage.ru_maxrss);
    info.phases = phases_of(result.design, folder_);
    write_report(scene_, result, folder_);
    return result;
  }

  /// Writes the result of a run that failed. A full disk may refuse it: the first failure is the
  /// one to tell.
  void write_failed(RunResult result, const std::string& why) {
    try {
      write(std::move(result), "failed", why);
    } catch (const std::exception&) {
    }
  }

 private:
  const Scene& scene_;
  RunFolder& folder_;
  int threads_;
  Clock::time_point begin_;
};

/// Writes the end of a run that failed or was interrupted.
/// @return the exit code of an interrupted run. @throws the error of the run
int end_early(EndedRun& ended, RunFiles& files, Progress& progress, const RunFolder& folder) {
  try {
    std::rethrow_exception(ended.error);
  } catch (const Interrupted&) {
    files.write(std::move(ended.result), "interrupted", "");
    progress.say("interrupted: what was computed is in " + folder.path());
    return 4;
  } catch (const std::exception& error) {
    ended.result.failure = failure_of(error, progress.where());
    files.write_failed(std::move(ended.result), error.what());
    throw;
  }
}

/// Writes the result of a run that came to its end.
/// @throws Error (numerical) when a page or a picture cannot be written: the results are whole, and
/// the run has failed
RunResult end_well(RunResult& result, RunFiles& files, Progress& progress) {
  try {
    return files.write(result, "done", "");
  } catch (const Error& error) {
    result.failure = failure_of(error, progress.where());
    files.write_failed(std::move(result), error.what());
    throw;
  }
}

/// Says warnings, missed expectations and where the report is. @return exit code
int say_end(const RunResult& result, bool is_case, Progress& progress, const std::string& path) {
  for (const Warning& each : result.warnings)
    progress.object(each.unusable ? "not usable" : "warning", each.words);
  size_t missed = 0;
  for (const Expected& expected : result.expectations) {
    if (expected.holds) continue;
    missed += is_case;
    progress.object(is_case ? "missed" : "not as the case without --set", expected.words);
  }
  progress.say(result.info.status + ": " + summary_words(result) +
               counted(result.warnings.size(), "warning", "warnings") +
               counted(missed, "expectation missed", "expectations missed") + ": " + path +
               "/report.html");
  return missed > 0 || !usable(result.warnings) ? kMissed : 0;
}

}  // namespace

EndedRun run_prepared(const RunContext& run) {
  const Scene& scene = run.scene();
  EndedRun out;
  DesignRun designs(run);
  try {
    if (!scene.designs.empty() || scene.domain)
      designs.run();
    else if (scene.statics)
      out.result.path = run_statics(run);
    else
      out.result.motions.motion = run_only_motion(run);
    run.folder.finish();
    out.result.info.lost_frames = run.folder.lost_frames();
    out.result.info.missing_exports = run.folder.missing_exports();
  } catch (const std::bad_alloc&) {
    out.error =
        std::make_exception_ptr(Error::numerical(out_of_memory_words(run.prepared.extent())));
  } catch (...) {
    out.error = std::current_exception();
  }
  if (!scene.designs.empty() || scene.domain) {
    out.result.design = designs.take_design();
    out.result.motions = designs.take_motions();
  }
  return out;
}

int run_case(const RunOptions& options) {
  const Clock::time_point begin = Clock::now();
  // What cannot be built, or is too large, is refused before a folder exists.
  const auto [file, prepared] =
      ready_case(options.case_name, options.overrides, options.directory, options.threads);
  const Scene& scene = prepared.scene();
  std::string directory = options.directory;
  if (directory.empty()) directory = scene.output.directory;
  if (directory.empty()) directory = "runs/" + scene.name;
  if (options.resume)
    if (const std::optional<int> code = finished_with(directory, options, file)) {
      remove_progress_of_finished(directory);
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
  RunFiles files(scene, folder, options.threads, begin);
  files.write({}, "running", "");
  EndedRun ended = run_prepared({prepared, folder, progress, [] { return !interrupted; },
                                 options.threads, options.condition, options.resume});
  if (ended.error) return end_early(ended, files, progress, folder);
  const RunResult result = end_well(ended.result, files, progress);
  remove_progress([&](const std::string& ending) { return folder.files_of(ending); });
  return say_end(result, !is_another_case(options.overrides), progress, directory);
}

}  // namespace flexmorph::cases
