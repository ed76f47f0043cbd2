#pragma once

#include <chrono>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "cases/results/failure.h"
#include "cases/run/work_plan.h"
#include "optim/mmc/cycles/esl_loop.h"

namespace flexmorph::cases {

/// The progress display of a run: the phase, the part of the run that is completed, and the range
/// of the time that is left. On a terminal it is one line that is overwritten, at least every
/// second; elsewhere a line is printed at intervals. Several threads may report their motions at
/// the same time.
class Progress {
 public:
  /// Creates a display that prints on the terminal.
  /// @param quiet  true if only warnings and errors are printed
  explicit Progress(bool quiet);
  /// Creates a display that prints nothing: messages and progress lines are passed to a function.
  explicit Progress(std::function<void(const std::string&)> told);
  ~Progress();

  /// Prints a message on a line of its own.
  /// @param even_if_quiet  true for messages that a quiet display prints, too
  void say(const std::string& text, bool even_if_quiet = false);
  /// Prints a warning or an error on the error stream, also if the run is quiet. The kind is
  /// coloured if the error stream is a terminal.
  void object(const std::string& kind, const std::string& text);

  /// Sets a function that receives the position of the run in words whenever progress is reported.
  /// Calls do not overlap.
  void watch(std::function<void(const std::string&)> watcher);
  /// Sets the planned phases, from which the remaining time is estimated.
  void plan(WorkPlan phases);
  /// Starts a phase of the run.
  void begin(const std::string& phase);
  /// Shows a design iteration.
  void iteration(const mmc::IterationReport& report);
  /// Shows the progress of a phase.
  /// @param part   completed fraction of the phase, 0..1
  /// @param words  position of the phase in words: "t = 0.3 of 1 s"
  /// @param may_end_early  true if the phase may end before its fraction is 1
  void way(const std::string& phase, double part, const std::string& words,
           bool may_end_early = false);

  /// Returns the phase, body, cycle and iteration that were reported last.
  Failure where() const;

 private:
  using Clock = std::chrono::steady_clock;
  void call_watcher(std::unique_lock<std::mutex>& lock, const std::string& text);
  // The lock has to be held by the callers of these functions.
  double seconds() const;
  std::string with_time(const std::string& text) const;
  void line(const std::string& head, const std::string& tail, bool now);
  void print(const std::string& text);
  void end_line();
  void keep_showing(const std::stop_token& stop);

  mutable std::mutex lock_;
  std::mutex watching_;  // held while the watcher is called or replaced
  bool quiet_, terminal_, open_ = false;
  std::function<void(const std::string&)> told_;  // empty: messages are printed
  std::function<void(const std::string&)> watcher_ = [](const std::string&) {};
  Failure where_;
  WorkPlan plan_;
  Clock::time_point begin_ = Clock::now(), shown_ = {}, watched_ = {};
  std::string last_;         // text of the last line without the time
  std::jthread repetition_;  // shows the line again while nothing is reported (terminals only)
};

}  // namespace flexmorph::cases
