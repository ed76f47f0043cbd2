#pragma once

#include <chrono>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "cases/output/run_folder.h"
#include "cases/results/run_result.h"
#include "cases/run/progress.h"

/// How runs end: by signals, by errors, or with their results written.
namespace flexmorph::cases {

/// Exit code of a run that is whole, but misses an expectation of its case or is of no use.
inline constexpr int kMissed = 5;

/// Makes SIGINT, SIGTERM and SIGHUP end a run: it ends its step or iteration and writes what it
/// has; a second one stops at once. A reader of the output that leaves ends no run.
void end_on_signals();
/// Tells whether no such signal has come.
bool goes_on();

/// Tells whether options make another case, of which [expect] does not speak.
bool is_another_case(std::span<const std::string> overrides);

/// Removes files that only resuming needs, of a run whose results are all written: until then a run
/// that is killed can be resumed.
/// @param files_of  paths of the files of the run whose names end so
void remove_progress(
    const std::function<std::vector<std::string>(const std::string& ending)>& files_of);

/// Fills what a result says of itself: status, warnings, expectations, CPU time and memory of the
/// process.
/// @param status  "done" becomes "done, not usable" where a warning says so
void complete_result(const Scene& scene, const std::string& status, const std::string& message,
                     RunResult& result);

/// Writes the files of a run in its folder that all runs have: at the start, and with the results.
class RunFiles {
 public:
  using Clock = std::chrono::steady_clock;

  /// @param begin  time at which the program began with the run
  RunFiles(const Scene& scene, RunFolder& folder, int threads, Clock::time_point begin)
      : scene_(scene), folder_(folder), threads_(threads), begin_(begin) {}

  /// Completes a result and writes it with its report.
  /// @param status  "done" becomes "done, not usable" where a warning says so
  /// @return the result as it was written
  /// @throws Error (numerical) when a file cannot be written
  RunResult write(RunResult result, const std::string& status, const std::string& message);

  /// Writes the result of a run that failed. A full disk may refuse it: the first failure is the
  /// one to tell.
  void write_failed(RunResult result, const std::string& why);

  RunFolder& folder() { return folder_; }

 private:
  const Scene& scene_;
  RunFolder& folder_;
  int threads_;
  Clock::time_point begin_;
};

/// Writes the results of a run and says its warnings, the expectations that it misses, and where
/// its report is.
/// @param is_case  whether expectations count: the case is as its file says
/// @return exit code: 0 done, 4 interrupted (what was computed is written), kMissed
/// @throws the error of the run, after its files; Error (numerical) when a file cannot be written
int end_run(EndedRun ended, bool is_case, RunFiles& files, Progress& progress);

}  // namespace flexmorph::cases
