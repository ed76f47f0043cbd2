#include "cases/run/run_end.h"

#include <sys/resource.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <csignal>
#include <filesystem>

#include "cases/output/report.h"
#include "cases/results/expectations.h"
#include "cases/results/summary.h"
#include "cases/results/warnings.h"
#include "cases/run/design_run.h"
#include "cases/run/motions.h"

namespace flexmorph::cases {
namespace {

std::atomic<bool> interrupted = false;  // set by a signal, read by every motion
std::atomic<bool> over_time = false;    // set by the signal of the timer
double time_limit = 0;                  // [s]

/// Returns the CPU times of the phases of a run with designs [s]: iterations, outlines of final
/// designs, post-processing, motions, verification of outlines, and motions that assess designs.
/// The result is empty without designs.
Seconds phases_of(const DesignResult& design, const RunFolder& folder) {
  Seconds out = folder.phases();
  if (out.empty()) return out;
  for (auto& [name, seconds] : out)
    if (name == "outlines")
      for (const mmc::BodyOutcome& o : design.outcomes) seconds += o.crisp.seconds_outlines;
  double outlines = 0;
  for (const VerifiedOutline& v : design.outlines) outlines += v.seconds;
  out.emplace_back("unloaded_components", design.seconds_unloaded);
  out.emplace_back("motion", design.seconds_motion);
  out.emplace_back("outline_verification", outlines);
  out.emplace_back("verification", design.seconds_verification);
  return out;
}

}  // namespace

void end_on_signals() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP})
    std::signal(signal, [](int number) {
      if (!interrupted.exchange(true)) return;
      std::signal(number, SIG_DFL);
      std::raise(number);
    });
  std::signal(SIGPIPE, SIG_IGN);
}

void limit_cpu_time(double seconds) {
  if (seconds <= 0) return;
  time_limit = seconds;
  std::signal(SIGPROF, [](int) { over_time = true; });
  itimerval timer{};
  timer.it_value.tv_sec = static_cast<time_t>(seconds);
  timer.it_value.tv_usec =
      std::max<suseconds_t>(1, static_cast<suseconds_t>(1e6 * (seconds - std::floor(seconds))));
  setitimer(ITIMER_PROF, &timer, nullptr);
  const auto last = static_cast<rlim_t>(std::ceil(seconds + kSecondsAfterLimit));
  const rlimit limit{last, last};
  setrlimit(RLIMIT_CPU, &limit);
}

bool keeps_running() { return !interrupted && !over_time; }

bool is_another_case(std::span<const std::string> overrides) {
  return std::any_of(overrides.begin(), overrides.end(), [](const std::string& each) {
    return !each.starts_with("output.") && !each.starts_with("expect");
  });
}

void remove_progress(const FilesOf& files_of) {
  std::error_code none;
  for (const std::string& path : files_of(kEvaluations)) std::filesystem::remove(path, none);
  remove_checkpoints(files_of);
}

void complete_result(const Scene& scene, const std::string& status, const std::string& message,
                     RunResult& result) {
  result.warnings = warnings_of(scene, result);
  result.expectations = compare_expectations(scene, result);
  RunInfo& info = result.info;
  info.status = status == "done" ? done_text(result.warnings) : status;
  info.message = message;
}

RunResult RunFiles::write(RunResult result, const std::string& status, const std::string& message) {
  complete_result(scene_, status, message, result);
  RunInfo& info = result.info;
  info.threads = threads_;
  info.phases = phases_of(result.design, folder_);
  clock_.read(info);
  write_report(scene_, result, folder_);
  return result;
}

void RunFiles::write_failed(RunResult result, const std::string& why) {
  try {
    write(std::move(result), "failed", why);
  } catch (const std::exception&) {
  }
}

namespace {

/// Writes the result of a run that failed or was interrupted.
/// @return exit code of an interrupted run
/// @throws the error of a failed run
int end_early(EndedRun& ended, RunFiles& files, Progress& progress) {
  try {
    std::rethrow_exception(ended.error);
  } catch (const Interrupted&) {
    if (over_time && !interrupted) {
      Failure failure = progress.where();
      failure.kind = "limit";
      failure.seconds_limit = time_limit;
      failure.cause = "ended after " + io::to_text(time_limit, 3) + " CPU seconds";
      ended.result.failure = failure;
      files.write_failed(std::move(ended.result), failure.cause);
      throw Error::numerical(failure.cause);
    }
    files.write(std::move(ended.result), "interrupted", "");
    progress.say("interrupted: The results computed so far are in " + files.folder().path());
    return 4;
  } catch (const std::exception& error) {
    ended.result.failure = failure_of(error, progress.where());
    files.write_failed(std::move(ended.result), error.what());
    throw;
  }
}

/// Writes the result of a complete run.
/// @throws Error (numerical) if a page or a picture cannot be written; then the run counts as
///         failed, although its results are complete
RunResult end_well(RunResult& result, RunFiles& files, Progress& progress) {
  try {
    return files.write(result, "done", "");
  } catch (const Error& error) {
    result.failure = failure_of(error, progress.where());
    files.write_failed(std::move(result), error.what());
    throw;
  }
}

/// Prints the warnings, the violated expectations and the path of the report.
/// @return exit code of the run
int say_end(const RunResult& result, bool is_case, Progress& progress, const std::string& path) {
  for (const std::string& note : notes_of(result)) progress.say(note);
  for (const Warning& each : result.warnings)
    progress.object(each.unusable ? "not usable" : "warning", each.words);
  size_t missed = 0;
  for (const Expected& expected : result.expectations) {
    if (expected.holds) continue;
    missed += is_case;
    progress.object(is_case ? "expectation not met" : "different from the case without --set",
                    expected.words);
  }
  progress.say(result.info.status + ": " + summary_text(result) +
               counted(result.warnings.size(), "warning", "warnings") +
               counted(missed, "expectation not met", "expectations not met") + ": " + path +
               "/report.html");
  return missed > 0 || !usable(result.warnings) ? kExpectationsMissed : 0;
}

}  // namespace

int end_run(EndedRun ended, bool is_case, RunFiles& files, Progress& progress) {
  if (ended.error) return end_early(ended, files, progress);
  const RunResult result = end_well(ended.result, files, progress);
  remove_progress([&](const std::string& ending) { return files.folder().files_of(ending); });
  return say_end(result, is_case, progress, files.folder().path());
}

}  // namespace flexmorph::cases
