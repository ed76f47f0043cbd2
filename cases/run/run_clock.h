#pragma once

#include <chrono>
#include <string>

#include "cases/results/run_result.h"

/// The times of a run and of its interrupted calls.
namespace flexmorph::cases {

/// Measures the wall time, the CPU time and the peak memory of a run. A run that is continued
/// counts the calls before as well.
class RunClock {
 public:
  /// Begins to measure now.
  RunClock();
  /// Returns a clock that also counts the CPU time since the start of the process.
  static RunClock since_process_start();

  /// Adds the times of the earlier calls of a run: those in its run.json, or later ones that keep()
  /// has written. Files that do not exist or have no times add nothing.
  /// @param folder  path of the folder of the run
  /// @throws Error (input) for a file that exists and cannot be read.
  void add_earlier(const std::string& folder);
  /// Writes the times until now to a file, so that a call that is killed afterwards is counted. At
  /// most two writes in a second are made; errors of writing are ignored.
  /// @param path  path of the file kTimesFile in the folder of the run
  void keep(const std::string& path);

  /// Sets wall time, CPU time and peak memory, and adds the earlier calls to the CPU times of the
  /// phases that the design iterations do not count.
  void read(RunInfo& info) const;

 private:
  using Clock = std::chrono::steady_clock;

  Clock::time_point begin_ = Clock::now(), next_ = begin_;
  double cpu_begin_;
  RunInfo earlier_;
};

/// Name of the file that RunClock::keep() writes.
inline constexpr const char* kTimesFile = "times.checkpoint";

}  // namespace flexmorph::cases
