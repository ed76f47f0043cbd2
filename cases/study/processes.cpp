#include "cases/study/processes.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <ctime>
#include <map>
#include <thread>

#include "geometry/base.h"

namespace flexmorph::cases {
namespace {

using Clock = std::chrono::steady_clock;

volatile std::sig_atomic_t interrupted = 0;

double since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

pid_t start(const Child& child, const ChildLimits& limits) {
  std::vector<std::string> words = child.words;
  words.insert(words.begin(), "flexmorph");
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const int out = open(child.log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (out < 0) throw Error::input("log '" + child.log + "' cannot be written");
  const auto bytes = static_cast<rlim_t>(limits.memory);
  const rlimit memory{bytes, bytes}, no_core{0, 0};
  const pid_t parent = getpid(), pid = fork();
  if (pid < 0) throw Error::numerical("a process cannot be started");
  if (pid == 0) {
    prctl(PR_SET_PDEATHSIG, SIGTERM);  // the runs end if the study is killed
    if (getppid() != parent) _exit(127);
    if (limits.memory > 0) setrlimit(RLIMIT_AS, &memory);
    setrlimit(RLIMIT_CORE, &no_core);
    dup2(out, STDOUT_FILENO);
    dup2(out, STDERR_FILENO);
    execv(child.program.c_str(), argv.data());
    _exit(127);
  }
  close(out);
  return pid;
}

/// Returns the CPU time of a process that was not waited for yet [s]; 0 if it is unknown.
double cpu_seconds_of(pid_t pid) {
  clockid_t clock{};
  timespec time{};
  if (clock_getcpuclockid(pid, &clock) != 0 || clock_gettime(clock, &time) != 0) return 0;
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// A running child: its index in the list, and the time of the SIGINT that it received.
struct Running {
  size_t location = 0;
  Clock::time_point begin = Clock::now(), asked = {};
  double asked_at_cpu = 0;  // CPU time at the SIGINT [s]
  bool over_time = false, told = false;
};

Ending ending_of(int status, const rusage& usage, const Running& child) {
  Ending out;
  out.over_time = child.over_time;
  out.interrupted = child.told;
  if (WIFEXITED(status)) out.code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) out.signal = WTERMSIG(status);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  out.seconds = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  return out;
}

/// Sends SIGINT to children that exceed their time limit or that have to be interrupted, and kills
/// children that do not end after it.
void keep_limits(std::map<pid_t, Running>& running, const ChildLimits& limits) {
  for (auto& [pid, child] : running) {
    if (child.over_time || child.told) {
      const bool late = cpu_seconds_of(pid) > child.asked_at_cpu + limits.grace ||
                        since(child.asked) > (child.told ? 1 : 10) * limits.grace;
      if (late) kill(pid, SIGKILL);
      continue;
    }
    const bool over = limits.seconds > 0 && (cpu_seconds_of(pid) > limits.seconds ||
                                             since(child.begin) > 10 * limits.seconds);
    if (!over && !interrupted) continue;
    (over ? child.over_time : child.told) = true;
    child.asked = Clock::now();
    child.asked_at_cpu = cpu_seconds_of(pid);
    kill(pid, SIGINT);
  }
}

}  // namespace

bool run_children(const std::vector<Child>& children, int jobs, const ChildLimits& limits,
                  const ChildObserver& observer) {
  interrupted = 0;
  struct sigaction action {};
  action.sa_handler = [](int) { interrupted = 1; };  // without SA_RESTART, system calls end
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  std::map<pid_t, Running> running;
  size_t next = 0;
  while (!running.empty() || (next < children.size() && !interrupted)) {
    while (!interrupted && next < children.size() && running.size() < static_cast<size_t>(jobs)) {
      const pid_t pid = start(children[next], limits);
      running[pid].location = next;
      if (observer.started) observer.started(next);
      ++next;
    }
    keep_limits(running, limits);
    bool any = false;
    for (auto at = running.begin(); at != running.end();) {
      int status = 0;
      rusage usage{};
      if (wait4(at->first, &status, WNOHANG, &usage) != at->first) {
        ++at;
        continue;
      }
      const Running child = at->second;
      at = running.erase(at);
      any = true;
      observer.ended(child.location, ending_of(status, usage, child));
    }
    if (observer.waiting && !running.empty()) {
      std::vector<size_t> locations;
      for (const auto& [pid, child] : running) locations.push_back(child.location);
      std::sort(locations.begin(), locations.end());
      observer.waiting(locations);
    }
    if (!any) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return !interrupted;
}

}  // namespace flexmorph::cases
