#include "cases/run/run.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <new>
#include <nlohmann/json.hpp>

#include "cases/assembly/resource_estimate.h"
#include "cases/check/ready.h"
#include "cases/output/kept_case.h"
#include "cases/output/paraview_script.h"
#include "cases/run/compute.h"
#include "cases/run/design_run.h"
#include "cases/run/live_page.h"
#include "cases/run/motions.h"
#include "cases/run/path_run.h"
#include "io/case_files/case_parser.h"
#include "io/files.h"
#include "io/screen.h"
#include "io/shell.h"

namespace flexmorph::cases {
namespace {

/// Follows the path of equilibria of a [static] analysis.
/// @param unfinished  receives the rows before a failure if there is no run folder
PathRecord run_statics(const RunContext& run, std::optional<PathRecord>& unfinished) {
  const double to = run.scene().statics->to, most = run.scene().statics->max_steps;
  // A path of arc length turns back at limit points. Its number of steps has only an upper bound.
  const bool turns = run.scene().statics->path != fem::StaticSettings::Path::load;
  double steps = 0;
  run.progress.begin("statics");
  PathRequest request;
  if (run.folder == nullptr) request.unfinished = &unfinished;
  request.condition = run.condition;
  request.keep_running = run.keep_running;
  request.reached = [&](double factor) {
    const double part = turns ? steps++ / most : factor / to;
    run.progress.way("statics", std::clamp(part, 0.0, 1.0),
                     "load factor " + io::to_text(factor, 4) + " of " + io::to_text(to, 4), turns);
  };
  PathRecord out = run_path(run.prepared, request, run.folder);
  run.progress.say("statics: load factor " + io::to_text(out.result.factor, 5) + " reached after " +
                   std::to_string(out.result.steps) + " steps and " +
                   std::to_string(out.result.iterations) + " Newton iterations");
  return out;
}

/// Computes the motion of a case without designs.
/// @param unfinished  receives the rows before a failure if there is no run folder
MotionRecord run_only_motion(const RunContext& run, std::optional<MotionRecord>& unfinished) {
  MotionRequest request = result_request(run, "motion");
  if (run.folder == nullptr) request.unfinished = &unfinished;
  request.say = [&](const std::string& words) { run.progress.say(words); };
  run.progress.begin(request.phase);
  MotionRecord out = run_motion(run.prepared, request, run.folder).record;
  const fem::MotionResult& result = out.result;
  run.progress.say("motion: " + std::to_string(result.counts.steps) + " time steps, " +
                   std::to_string(result.counts.newton) + " Newton iterations, " +
                   mesh_text(run.prepared.scene(), result));
  return out;
}

/// Returns the exit code of the complete run in a folder; nothing if there is no complete run, so
/// that a run has to be started or resumed.
/// @throws Error (input) if the run in the folder belongs to another case.
std::optional<int> finished_with(const std::string& directory, const RunOptions& options,
                                 const io::CaseFile& file) {
  const std::string path = directory + "/run.json";
  if (!std::filesystem::exists(path)) return {};
  if (!keeps_case(directory, file))
    throw Error::input("'" + directory +
                       "' contains a run of another case, or of this case before it was "
                       "changed. This run cannot be resumed. Without --resume, it is moved to "
                       "another folder and a new run starts");
  const nlohmann::json run = nlohmann::json::parse(io::read_text(path));
  const std::string status = run.value("status", "");
  if (!status.starts_with("done")) return {};
  bool missed = status != "done";  // "done, not usable"
  const nlohmann::json expect = run.value("expect", nlohmann::json::object());
  for (const auto& [name, expected] : expect.items())
    missed = missed || (!is_another_case(options.overrides) && !expected.value("holds", true));
  return missed ? kExpectationsMissed : 0;
}

/// Removes the files that only resuming needs, from the folder of a complete run that was killed
/// before it removed these files.
void remove_progress_of_finished(const std::string& directory) {
  try {
    io::OutputFolder folder(directory, io::OutputFolder::Begin::keep_running);
    remove_progress([&](const std::string& ending) { return folder.files_of(ending); });
  } catch (const Error&) {  // locked or read-only folder: the files may stay
  }
}

}  // namespace

std::string resume_command(const RunOptions& options) {
  std::vector<std::string> words = {"flexmorph run " + io::shell_word(options.case_name)};
  for (const std::string& change : options.overrides)
    words.push_back("--set " + io::shell_word(change));
  if (!options.directory.empty()) words.push_back("-o " + io::shell_word(options.directory));
  if (options.threads != 1) words.push_back("--threads " + std::to_string(options.threads));
  if (options.seconds > 0) words.push_back("--seconds " + io::to_text(options.seconds));
  if (options.condition) words.emplace_back("--condition");
  if (options.explain) words.emplace_back("--explain");
  words.emplace_back("--resume");
  std::string out;
  size_t column = 2;
  for (const std::string& word : words) {
    constexpr size_t kEnd = 2;  // columns of the mark of a line that goes on
    const bool begins = out.empty();
    if (!begins && column + 1 + io::columns_of(word) + kEnd > io::screen_width()) {
      out += " \\\n    ";
      column = 4;
    } else {
      out += begins ? "  " : " ";
      column += begins ? 0 : 1;
    }
    out += word;
    column += io::columns_of(word);
  }
  return out;
}

EndedRun run_prepared(const RunContext& run) {
  const Scene& scene = run.scene();
  EndedRun out;
  DesignRun designs(run);
  try {
    if (!scene.designs.empty() || scene.domain)
      designs.run();
    else if (scene.statics)
      out.result.path = run_statics(run, out.result.path);
    else
      out.result.motions.motion = run_only_motion(run, out.result.motions.motion);
    if (run.folder) {
      run.folder->finish();
      out.result.info.lost_frames = run.folder->lost_frames();
      out.result.info.missing_exports = run.folder->missing_exports();
    }
  } catch (const std::bad_alloc&) {
    out.error = std::make_exception_ptr(
        Error::numerical(out_of_memory_text(run.prepared.resource_estimate())));
  } catch (...) {
    out.error = std::current_exception();
  }
  if (!scene.designs.empty() || scene.domain) {
    out.result.design = designs.take_design();
    out.result.motions = designs.take_motions();
  }
  return out;
}

namespace {

/// Runs a case in its folder and reports to a display.
/// @param settings  callbacks of the run
int run_in_folder(const ReadyCase& ready, const std::string& directory, const RunOptions& options,
                  const ComputeSettings& settings, Progress& progress, RunClock clock) {
  const io::CaseFile& file = ready.file;
  const PreparedCase& prepared = ready.prepared;
  const Scene& scene = prepared.scene();
  if (options.resume)
    if (const std::optional<int> code = finished_with(directory, options, file)) {
      remove_progress_of_finished(directory);
      progress.say(directory + ": The run is complete already. Nothing was computed.", true);
      return *code;
    }
  RunFolder folder(directory, scene, options.threads > 1,
                   options.resume ? RunFolder::Begin::keep_running : RunFolder::Begin::anew);
  if (options.resume && !scene.statics) clock.add_earlier(directory);
  keep_case(file, options.explain, folder);
  if (scene.output.vtk) folder.write_text("paraview.py", kParaViewScript);
  progress.plan({phase_costs(scene, scene.domain ? nullptr : &prepared.mechanism()),
                 iteration_costs(scene), options.threads});
  progress.say(scene.title + ": The results are written to " + directory);
  if (options.resume && scene.statics)
    progress.say(
        "A path of equilibria cannot be resumed. The computation starts from the beginning.");
  if (!folder.moved_to().empty())
    progress.say("The earlier run in this folder was moved to " + folder.moved_to());
  RunFiles files(scene, folder, options.threads, clock);
  files.write({}, "running", "");
  LivePage page(scene, folder);
  page.update("the model is built");
  const std::string times = scene.statics ? "" : folder.file(kTimesFile);
  progress.watch([&](const std::string& words) {
    page.update(words);
    if (!times.empty()) clock.keep(times);
  });
  if (options.open)
    if (const std::string why = open_on_desktop(directory + "/report.html"); !why.empty())
      progress.say(why, true);
  EndedRun ended = run_prepared({.prepared = prepared,
                                 .folder = &folder,
                                 .progress = progress,
                                 .keep_running = settings.keep_running,
                                 .threads = options.threads,
                                 .condition = options.condition,
                                 .resume = options.resume,
                                 .iteration = settings.iteration});
  const int code = end_run(std::move(ended), !is_another_case(options.overrides), files, progress);
  if (code == 4 && !scene.statics)
    progress.say("The command that continues this run:\n" + resume_command(options));
  return code;
}

}  // namespace

int run_case(const RunOptions& options) {
  const RunClock clock = RunClock::since_process_start();
  // A case that cannot be built or is too large is refused before a folder is created.
  const ReadyCase ready = ready_case(options.case_name, options.overrides, options.directory);
  const Scene& scene = ready.prepared.scene();
  std::string directory = options.directory;
  if (directory.empty()) directory = scene.output.directory;
  if (directory.empty()) directory = "runs/" + scene.name;
  end_on_signals();
  limit_cpu_time(options.seconds);
  Progress progress(options.quiet);
  ComputeSettings settings;
  settings.keep_running = keeps_running;
  return run_in_folder(ready, directory, options, settings, progress, clock);
}

int compute_into(const ReadyCase& ready, const std::string& directory,
                 const ComputeSettings& settings, bool resume) {
  RunOptions options;
  options.directory = directory;
  options.overrides = ready.overrides;
  options.threads = settings.threads;
  options.resume = resume;
  Progress progress(settings.say);
  ComputeSettings callbacks = settings;
  if (!callbacks.keep_running) callbacks.keep_running = [] { return true; };
  return run_in_folder(ready, directory, options, callbacks, progress, RunClock());
}

}  // namespace flexmorph::cases
