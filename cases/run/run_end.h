#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "cases/output/run_folder.h"
#include "cases/results/run_result.h"
#include "cases/run/progress.h"
#include "cases/run/run_clock.h"

/// The end of a run: after a signal, after an error, or with all results written.
namespace flexmorph::cases {

/// Exit code of a run that is complete, but violates an expectation of its case or is not usable.
inline constexpr int kExpectationsMissed = 5;

/// Installs handlers with which SIGINT, SIGTERM and SIGHUP end a run: the run completes its current
/// step or iteration and writes its results. A second signal ends the process at once. SIGPIPE is
/// ignored, so that a run continues when the reader of its output ends.
void end_on_signals();
/// Limits the CPU time of the process. At the limit the run completes its current step or iteration
/// and fails with the results so far (Failure::kind is "limit"). The system ends a process that
/// needs kSecondsAfterLimit more.
/// @param seconds  limit [s]; 0: none
void limit_cpu_time(double seconds);
/// CPU time between the limit of limit_cpu_time() and the end of the process by the system [s].
inline constexpr double kSecondsAfterLimit = 60;

/// Tells whether none of the signals of end_on_signals() was received and no limit of
/// limit_cpu_time() is reached.
bool keeps_running();

/// Tells whether overrides change the case, so that [expect] does not apply to it. Overrides of
/// output and of expectations do not change the case.
bool is_another_case(std::span<const std::string> overrides);

/// Removes the files that are needed only to resume a run. It is called when all results of the run
/// are written, so that a run that is killed earlier can be resumed.
/// @param files_of  returns the paths of the files of the run whose names have the given ending
void remove_progress(
    const std::function<std::vector<std::string>(const std::string& ending)>& files_of);

/// Fills the general fields of a result except times: status, message, warnings and expectations.
/// @param status  "done" becomes "done, not usable" if a warning makes the result unusable
void complete_result(const Scene& scene, const std::string& status, const std::string& message,
                     RunResult& result);

/// A writer of the files that every run has in its folder: run.json and the report.
class RunFiles {
 public:
  /// Creates the writer; the scene, the folder and the clock have to outlive it.
  /// @param clock  clock that began to measure when the program began with the run
  RunFiles(const Scene& scene, RunFolder& folder, int threads, const RunClock& clock)
      : scene_(scene), folder_(folder), threads_(threads), clock_(clock) {}

  /// Completes a result and writes it with its report.
  /// @param status  "done" becomes "done, not usable" if a warning makes the result unusable
  /// @return the result as it was written
  /// @throws Error (numerical) when a file cannot be written
  RunResult write(RunResult result, const std::string& status, const std::string& message);

  /// Writes the result of a run that failed. Errors of writing, for example of a full disk, are
  /// ignored, because the first failure is the one to report.
  void write_failed(RunResult result, const std::string& why);

  /// Returns the folder of the run.
  RunFolder& folder() { return folder_; }

 private:
  const Scene& scene_;
  RunFolder& folder_;
  int threads_;
  const RunClock& clock_;
};

/// Writes the results of a run and prints its warnings, the expectations that it violates, and the
/// path of its report.
/// @param is_case  true if expectations count, because no override changes the case
/// @return exit code: 0 for a complete run, 4 for an interrupted run (its results so far are
///         written), or kExpectationsMissed
/// @throws the error of the run, after its files; Error (numerical) when a file cannot be written
int end_run(EndedRun ended, bool is_case, RunFiles& files, Progress& progress);

}  // namespace flexmorph::cases
