#include "cases/run/progress.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "cases/assembly/resource_estimate.h"
#include "geometry/text.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

constexpr double kTerminal = 0.1, kElsewhere = 30;  // time between lines [s]

/// Returns the number of columns of the terminal; 80 if it is unknown.
int columns() {
  winsize size{};
  const bool known = ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1;
  return known ? size.ws_col : 80;
}

}  // namespace

std::string time_left(double seconds, double part) {
  if (!(part > 0) || seconds < 0.5) return "";
  return ", " + duration_text(seconds * (1 - std::min(1.0, part)) / part) + " left";
}

Progress::Progress(bool quiet) : quiet_(quiet), terminal_(isatty(STDOUT_FILENO) != 0) {}

Progress::Progress(std::function<void(const std::string&)> told)
    : quiet_(true), terminal_(false), told_(told ? std::move(told) : [](const std::string&) {}) {}

Progress::~Progress() { end_line(); }

void Progress::say(const std::string& text) {
  const std::lock_guard guard(lock_);
  if (told_) return told_(text);
  end_line();
  if (!quiet_) std::printf("%s\n", text.c_str());
  std::fflush(stdout);
}

void Progress::object(const std::string& kind, const std::string& text) {
  const std::lock_guard guard(lock_);
  end_line();
  const bool colour = isatty(STDERR_FILENO) != 0 && std::getenv("NO_COLOR") == nullptr;
  const char* const before = !colour ? "" : kind == "warning" ? "\x1b[33m" : "\x1b[31m";
  std::fprintf(stderr, "flexmorph: %s%s:%s %s\n", before, kind.c_str(), colour ? "\x1b[0m" : "",
               text.c_str());
}

void Progress::begin(const std::string& phase) {
  const std::lock_guard guard(lock_);
  where_.phase = phase;
  begin_ = shown_ = Clock::now();
}

double Progress::since_begin() const {
  return std::chrono::duration<double>(Clock::now() - begin_).count();
}

void Progress::iteration(const mmc::IterationReport& r, double most) {
  const std::lock_guard guard(lock_);
  if (where_.phase != "design") {
    where_.phase = "design";
    begin_ = Clock::now();
    iterations_ = 0;
  }
  where_.body = r.problem.body;
  where_.cycle = r.cycle;
  where_.iteration = r.iteration;
  ++iterations_;
  ++all_;
  std::string text = "design of " + r.problem.body + ", cycle " + std::to_string(r.cycle) +
                     ": iteration " + std::to_string(r.iteration);
  // With several bodies or cycles, the total of the run is added in parentheses, because the number
  // of the iteration restarts at 1 for every body and cycle.
  const bool alone = all_ == r.iteration;
  text += (alone ? " of at most " : " (total " + io::to_text(all_) + " of at most ") +
          io::to_text(most) + (alone ? "" : ")");
  text += time_left(since_begin(), iterations_ / (iterations_ + most - all_));
  // The compliance is not finite if the goal contains none.
  if (std::isfinite(r.state.compliance()))
    text += ", compliance " + formatted("%.5g", r.state.compliance());
  text += ", volume fraction " + formatted("%.4f", r.state.volume()) + ", KKT residual " +
          formatted("%.1e", r.iterate.kkt);
  line(text, r.iteration == 1 || r.iteration % 25 == 0);
}

void Progress::way(const std::string& phase, double part, const std::string& words) {
  if (quiet_) return;
  const std::lock_guard guard(lock_);
  const double pause = std::chrono::duration<double>(Clock::now() - shown_).count();
  if (pause < (terminal_ ? kTerminal : kElsewhere)) return;
  shown_ = Clock::now();
  line(phase + ": " + words + ", " + formatted("%.0f", 100 * part) + " %" +
           time_left(since_begin(), part),
       true);
}

Failure Progress::where() const {
  const std::lock_guard guard(lock_);
  return where_;
}

void Progress::line(const std::string& text, bool now) {
  if (quiet_ || (!terminal_ && !now)) return;
  if (terminal_) {
    // The line is cut to the width of the terminal, because a wrapped line cannot be overwritten.
    const int width = columns() - 1;
    std::printf("\r%-*.*s", width, width, text.c_str());
    open_ = true;
  } else {
    std::printf("%s\n", text.c_str());
  }
  std::fflush(stdout);
}

void Progress::end_line() {
  if (open_) std::printf("\n");
  open_ = false;
}

}  // namespace flexmorph::cases
