#include "tests/support/watch/watch.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "cases/process/environment.h"

namespace flexmorph::testing {
namespace {

using Clock = std::chrono::steady_clock;

/// Time that processes of a finished test have for their own end.
constexpr std::chrono::seconds kGrace{2};

struct Process {
  pid_t pid, parent;
  /// True for a zombie: the process has ended, but its parent has not collected the exit code.
  bool ended;
};

/// Returns all processes of this machine that are visible in /proc/PID/stat.
std::vector<Process> all_processes() {
  std::vector<Process> out;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator("/proc", ignored)) {
    const std::string name = entry.path().filename();
    pid_t pid = 0;
    if (std::from_chars(name.data(), name.data() + name.size(), pid).ec != std::errc{}) continue;
    std::ifstream in(entry.path() / "stat");
    const std::string text(std::istreambuf_iterator<char>(in), {});
    // The name of the program is in parentheses and may contain any character.
    const size_t close = text.rfind(')');
    if (close == std::string::npos) continue;
    std::istringstream rest(text.substr(close + 1));
    char state = 0;
    Process p{pid, 0, false};
    if (!(rest >> state >> p.parent)) continue;
    p.ended = state == 'Z' || state == 'X';
    out.push_back(p);
  }
  return out;
}

/// Returns the processes that descend from this one and have not ended.
std::vector<pid_t> descendants() {
  const std::vector<Process> all = all_processes();
  std::vector<pid_t> family{getpid()}, out;
  for (size_t k = 0; k < family.size(); ++k)
    for (const Process& p : all)
      if (p.parent == family[k]) {
        family.push_back(p.pid);
        if (!p.ended) out.push_back(p.pid);
      }
  return out;
}

std::string command_of(pid_t pid) {
  std::ifstream in("/proc/" + std::to_string(pid) + "/cmdline");
  std::string text(std::istreambuf_iterator<char>(in), {});
  std::replace(text.begin(), text.end(), '\0', ' ');
  return "process " + std::to_string(pid) + ": " + text;
}

constexpr int kNotEnded = -1;

/// Collects the exit codes of children that have ended.
/// @returns the status of `child` if it is among them, else kNotEnded
int collect(pid_t child) {
  int status = 0, found = kNotEnded;
  for (pid_t pid = 0; (pid = waitpid(-1, &status, WNOHANG)) > 0;)
    if (pid == child) found = status;
  return found;
}

/// Collects the children that have ended.
/// @returns true if this process has no child any more
bool has_no_child() {
  while (waitpid(-1, nullptr, WNOHANG) > 0) continue;
  return waitpid(-1, nullptr, WNOHANG) == -1 && errno == ECHILD;
}

}  // namespace

void kill_descendants() {
  for (const Clock::time_point end = Clock::now() + std::chrono::seconds(10); Clock::now() < end;) {
    for (const pid_t pid : descendants()) kill(pid, SIGKILL);
    if (has_no_child()) return;
    usleep(10'000);
  }
}

namespace {

/// Names and kills the processes that are left after the tests.
/// @returns true if there was one
bool left_behind() {
  for (const Clock::time_point end = Clock::now() + kGrace; Clock::now() < end; usleep(10'000))
    if (has_no_child()) return false;
  for (const pid_t pid : descendants())
    std::fprintf(stderr, "The test left a process behind; it is killed: %s\n",
                 command_of(pid).c_str());
  kill_descendants();
  return true;
}

/// Waits for the child and names the test that exceeds the limit.
/// @returns the exit code of the program
int watch(pid_t child, const RunningTest& running, double limit, const sigset_t& signals) {
  unsigned number = 0;
  Clock::time_point begun = Clock::now();
  for (;;) {
    if (const int status = collect(child); status != kNotEnded) {
      if (left_behind()) return 1;
      if (WIFEXITED(status)) return WEXITSTATUS(status);
      std::fprintf(stderr, "%s was ended by signal %d (%s)\n", running.name, WTERMSIG(status),
                   strsignal(WTERMSIG(status)));
      return 128 + WTERMSIG(status);
    }
    if (const unsigned now = running.number; now != number) number = now, begun = Clock::now();
    const double seconds = std::chrono::duration<double>(Clock::now() - begun).count();
    const timespec wait{0, 100'000'000};
    const int signal = sigtimedwait(&signals, nullptr, &wait);
    if (signal == SIGTERM || signal == SIGINT || signal == SIGHUP) {
      std::fprintf(stderr, "Interrupted by signal %d after %.1f s of the test %s\n", signal,
                   seconds, running.name);
    } else if (seconds > limit) {
      std::fprintf(stderr, "The test %s has taken more than %g s and is killed.\n", running.name,
                   limit);
    } else {
      continue;
    }
    for (const pid_t pid : descendants())
      std::fprintf(stderr, "Killed: %s\n", command_of(pid).c_str());
    kill_descendants();
    return 1;
  }
}

/// Starts a program as the child that runs the tests, with the environment of its libraries.
[[noreturn]] void start_child(int file, const char* program, char** argv) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  prctl(PR_SET_CHILD_SUBREAPER, 1);  // orphans of the tests become children of this process
  setenv(kMemoryVariable, std::to_string(file).c_str(), 1);
  set_environment(1);
  execv(program, argv);
  std::perror(program);
  _exit(1);
}

}  // namespace

double seconds_per_test() {
  const char* text = std::getenv("FLEXMORPH_TEST_SECONDS");
  return text ? std::strtod(text, nullptr) : kDefaultTestSeconds;
}

RunningTest* shared_memory(int file) {
  void* const memory =
      mmap(nullptr, sizeof(RunningTest), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  if (memory != MAP_FAILED) return static_cast<RunningTest*>(memory);
  std::perror("mmap");
  std::exit(1);
}

int watch_program(const char* program, char** argv) {
  const int file = memfd_create("watchdog", 0);
  if (file == -1 || ftruncate(file, sizeof(RunningTest)) != 0) return std::perror("memfd"), 1;
  const RunningTest& running = *shared_memory(file);
  prctl(PR_SET_CHILD_SUBREAPER, 1);
  sigset_t signals, before;
  sigemptyset(&signals);
  for (const int signal : {SIGCHLD, SIGTERM, SIGINT, SIGHUP}) sigaddset(&signals, signal);
  sigprocmask(SIG_BLOCK, &signals, &before);
  const pid_t child = fork();
  if (child == -1) return std::perror("fork"), 1;
  if (child == 0) {
    sigprocmask(SIG_SETMASK, &before, nullptr);
    start_child(file, program, argv);
  }
  close(file);
  return watch(child, running, seconds_per_test(), signals);
}

}  // namespace flexmorph::testing
