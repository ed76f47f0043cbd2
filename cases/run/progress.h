#pragma once

#include <chrono>
#include <functional>
#include <mutex>
#include <string>

#include "cases/results/failure.h"
#include "optim/mmc/cycles/esl_loop.h"

namespace flexmorph::cases {

/// The progress display of a run. On a terminal it is one line that is overwritten; elsewhere a
/// line is printed at intervals. Several threads may report their motions at the same time.
class Progress {
 public:
  /// Creates a display that prints on the terminal.
  /// @param quiet  true if only warnings and errors are printed
  explicit Progress(bool quiet);
  /// Creates a display that prints nothing: messages are passed to a function, and progress lines
  /// are discarded.
  explicit Progress(std::function<void(const std::string&)> told);
  ~Progress();

  /// Prints a message on a line of its own.
  void say(const std::string& text);
  /// Prints a warning or an error on the error stream, also if the run is quiet. The kind is
  /// coloured if the error stream is a terminal.
  void object(const std::string& kind, const std::string& text);

  /// Starts a phase of the run; the remaining time is estimated from this moment on.
  void begin(const std::string& phase);
  /// Shows a design iteration.
  /// @param most  largest number of iterations of the whole run: all bodies, stages and cycles
  void iteration(const mmc::IterationReport& report, double most);
  /// Shows the progress of a phase.
  /// @param part   completed fraction of the phase, 0..1
  /// @param words  position of the phase in words: "t = 0.3 of 1 s"
  void way(const std::string& phase, double part, const std::string& words);

  /// Returns the phase, body, cycle and iteration that were reported last.
  Failure where() const;

 private:
  using Clock = std::chrono::steady_clock;
  double since_begin() const;
  void line(const std::string& text, bool now);  // the lock has to be held
  void end_line();

  mutable std::mutex lock_;
  bool quiet_, terminal_, open_ = false;
  std::function<void(const std::string&)> told_;  // empty: messages are printed
  Failure where_;
  double all_ = 0, iterations_ = 0;  // iterations of the run, and since the phase began
  Clock::time_point begin_ = Clock::now(), shown_ = {};
};

/// Returns ", 45 s left", estimated from the elapsed time and the completed fraction; returns an
/// empty text if too little is completed.
/// @param seconds  elapsed time [s]
/// @param part     completed fraction, 0..1
std::string time_left(double seconds, double part);

}  // namespace flexmorph::cases
