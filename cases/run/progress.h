#pragma once

#include <chrono>
#include <functional>
#include <mutex>
#include <string>

#include "cases/results/failure.h"
#include "optim/mmc/cycles/esl_loop.h"

namespace flexmorph::cases {

/// What people see of a run on its way: a line that rewrites itself on a terminal, elsewhere a line
/// now and then. Several threads may tell of their motions.
class Progress {
 public:
  explicit Progress(bool quiet);
  /// Nothing is printed: sentences go to a function, lines that rewrite themselves nowhere.
  explicit Progress(std::function<void(const std::string&)> told);
  ~Progress();

  void say(const std::string& text);
  /// What is to be said against the run, also by a quiet one: in colour where people look on.
  void object(const std::string& kind, const std::string& text);

  /// A part of the run begins: its time left is reckoned from here.
  void begin(const std::string& phase);
  /// @param most  iterations of the whole run, all bodies, stages and cycles
  void iteration(const mmc::IterationReport& report, double most);
  /// @param part  of the way, 0..1; words say where that is: "t = 0.3 of 1 s"
  void way(const std::string& phase, double part, const std::string& words);

  /// Where the run is, as far as it was told.
  Failure where() const;

 private:
  using Clock = std::chrono::steady_clock;
  double since_begin() const;
  void line(const std::string& text, bool now);  // with the lock held
  void end_line();

  mutable std::mutex lock_;
  bool quiet_, terminal_, open_ = false;
  std::function<void(const std::string&)> told_;  // empty: sentences are printed
  Failure where_;
  double all_ = 0, iterations_ = 0;  // iterations of the run, and since the phase began
  Clock::time_point begin_ = Clock::now(), shown_ = {};
};

/// ", 45 s left" by the part that is done; nothing where too little is.
std::string time_left(double seconds, double part);

}  // namespace flexmorph::cases
