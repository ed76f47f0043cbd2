#include "cases/run/progress.h"

#include <unistd.h>

#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>

#include "cases/assembly/resource_estimate.h"
#include "geometry/text.h"
#include "io/files.h"
#include "io/screen.h"

namespace flexmorph::cases {
namespace {

constexpr double kTerminal = 0.1, kElsewhere = 30;      // time between lines [s]
constexpr std::chrono::milliseconds kWatched(100);      // least time between calls of the watcher
constexpr std::chrono::milliseconds kRepetition(1000);  // time after which a line is shown again

}  // namespace

Progress::Progress(bool quiet) : quiet_(quiet), terminal_(isatty(STDOUT_FILENO) != 0) {
  if (terminal_ && !quiet_)
    repetition_ = std::jthread([this](const std::stop_token& stop) { keep_showing(stop); });
}

Progress::Progress(std::function<void(const std::string&)> told)
    : quiet_(!told), terminal_(false), told_(told ? std::move(told) : [](const std::string&) {}) {}

Progress::~Progress() {
  if (repetition_.joinable()) {
    repetition_.request_stop();
    repetition_.join();
  }
  end_line();
}

/// Shows the last line again with a new time while nothing else is reported, so that long steps do
/// not look like a program that hangs.
void Progress::keep_showing(const std::stop_token& stop) {
  std::mutex waiting;
  std::condition_variable_any wake;
  std::unique_lock sleeping(waiting);
  while (!wake.wait_for(sleeping, stop, kRepetition / 2, [&] { return stop.stop_requested(); })) {
    const std::lock_guard guard(lock_);
    if (open_ && Clock::now() - shown_ >= kRepetition) print(with_time(last_));
  }
}

void Progress::say(const std::string& text, bool even_if_quiet) {
  const std::lock_guard guard(lock_);
  if (told_) return told_(text);
  end_line();
  if (!quiet_ || even_if_quiet)
    std::fputs(io::fitted_text(text, io::screen_width()).c_str(), stdout);
  std::fflush(stdout);
}

void Progress::object(const std::string& kind, const std::string& text) {
  const std::lock_guard guard(lock_);
  if (told_) return told_(kind + ": " + text);
  end_line();
  const bool colour = isatty(STDERR_FILENO) != 0 && std::getenv("NO_COLOR") == nullptr;
  const char* const before = !colour ? "" : kind == "warning" ? "\x1b[33m" : "\x1b[31m";
  const std::string all = io::fitted_text("flexmorph: " + kind + ": " + text, io::screen_width());
  const size_t at = std::string("flexmorph: ").size(), end = at + kind.size() + 1;
  std::fprintf(stderr, "%s%s%s%s%s", all.substr(0, at).c_str(), before,
               all.substr(at, end - at).c_str(), colour ? "\x1b[0m" : "", all.substr(end).c_str());
}

void Progress::begin(const std::string& phase) {
  const std::lock_guard guard(lock_);
  where_.phase = phase;
  shown_ = Clock::now();
  plan_.begin(phase, seconds());
  // The lines of other phases follow soon; this one is silent until its end.
  if (terminal_) line(phase, "", true);
}

void Progress::watch(std::function<void(const std::string&)> watcher) {
  const std::lock_guard guard(watching_);
  watcher_ = std::move(watcher);
}

/// Calls the watcher if it was not called a moment ago and no other thread is calling it. Time
/// steps can be short, and the remaining time costs an estimate. The lock of the display is
/// released first, because a watcher may take seconds, in which the line is shown again.
/// @param text  position of the run, without the time
void Progress::call_watcher(std::unique_lock<std::mutex>& lock, const std::string& text) {
  const Clock::time_point now = Clock::now();
  if (now - watched_ < kWatched) return;
  watched_ = now;
  const std::string words = with_time(text);
  lock.unlock();
  const std::unique_lock guard(watching_, std::try_to_lock);
  if (guard.owns_lock()) watcher_(words);
}

void Progress::plan(WorkPlan phases) {
  const std::lock_guard guard(lock_);
  plan_ = std::move(phases);
}

double Progress::seconds() const {
  return std::chrono::duration<double>(Clock::now() - begin_).count();
}

/// Returns a text with the completed part of the run and the time that is left.
std::string Progress::with_time(const std::string& text) const {
  const double now = seconds();
  const std::string left = left_text(plan_.left(now));
  if (left.empty()) return text;
  return text + ", " + formatted("%.0f", 100 * plan_.completed(now)) + " % of the run" + left;
}

void Progress::iteration(const mmc::IterationReport& r) {
  std::unique_lock guard(lock_);
  where_.phase = "design";
  where_.body = r.problem.body;
  where_.cycle = r.cycle;
  where_.iteration = r.iteration;
  plan_.iterate(r.problem.body, {r.iteration, r.with_widths, r.most_left, r.most_left_with_widths},
                seconds());
  const std::string head = "design of " + r.problem.body + ", cycle " + std::to_string(r.cycle) +
                           ": iteration " + std::to_string(r.iteration) + " of at most " +
                           std::to_string(r.iteration + r.most_left);
  std::string tail;
  // The compliance is not finite if the goal contains none.
  if (std::isfinite(r.state.compliance()))
    tail += ", compliance " + formatted("%.5g", r.state.compliance());
  tail += ", volume fraction " + formatted("%.4f", r.state.volume()) + ", KKT residual " +
          formatted("%.1e", r.iterate.kkt);
  line(head, tail, r.iteration == 1 || r.iteration % 25 == 0);
  call_watcher(guard, head);
}

void Progress::way(const std::string& phase, double part, const std::string& words,
                   bool may_end_early) {
  std::unique_lock guard(lock_);
  plan_.advance(phase, part, {may_end_early ? 0 : 1 - part, 1 - part}, seconds());
  const double pause = std::chrono::duration<double>(Clock::now() - shown_).count();
  if (!quiet_ && pause >= (terminal_ ? kTerminal : kElsewhere))
    line(phase + ": " + words, "", true);
  call_watcher(guard, phase + ": " + words);
}

Failure Progress::where() const {
  const std::lock_guard guard(lock_);
  return where_;
}

/// Shows a line: `head`, the time that is left, `tail`.
void Progress::line(const std::string& head, const std::string& tail, bool now) {
  if (quiet_ || (!terminal_ && !now)) return;
  last_ = head;
  print(with_time(head) + tail);
}

void Progress::print(const std::string& text) {
  shown_ = Clock::now();
  if (terminal_) {
    // The line is cut to the width of the terminal, because a wrapped line cannot be overwritten.
    const int width = static_cast<int>(io::screen_width()) - 1;
    std::printf("\r%-*.*s", width, width, text.c_str());
    open_ = true;
  } else if (told_) {
    told_(text);
  } else {
    std::fputs(io::fitted_text(text, io::screen_width()).c_str(), stdout);
  }
  std::fflush(stdout);
}

void Progress::end_line() {
  if (open_) std::printf("\n");
  open_ = false;
}

}  // namespace flexmorph::cases
