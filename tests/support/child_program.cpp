#include "tests/support/child_program.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <thread>

namespace flexmorph::testing {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

void pause_briefly() { std::this_thread::sleep_for(std::chrono::milliseconds(2)); }

void limit(int what, double bytes) {
  if (bytes <= 0) return;
  const auto most = static_cast<rlim_t>(bytes);
  const rlimit both{most, most};
  setrlimit(static_cast<__rlimit_resource_t>(what), &both);
}

/// Replaces a standard stream of the child process by a file.
void redirect(int stream, const std::string& path, int flags) {
  const int file = open(path.c_str(), flags, 0600);
  if (file < 0 || dup2(file, stream) < 0) _exit(126);
  close(file);
}

std::string text_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

ChildProgram::ChildProgram(const std::vector<std::string>& words, const std::string& folder,
                           const ChildLimits& limits)
    : folder_(folder) {
  const std::string out = folder.empty() ? "/dev/null" : folder + "/stdout",
                    err = folder.empty() ? "/dev/null" : folder + "/stderr";
  std::vector<char*> argv;
  for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  std::fflush(nullptr);  // otherwise both processes would write the contents of the buffers
  const pid_t parent = getpid();
  pid_ = fork();
  if (pid_ != 0) return;
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(126);
  redirect(STDIN_FILENO, "/dev/null", O_RDONLY);
  redirect(STDOUT_FILENO, out, O_WRONLY | O_CREAT | O_TRUNC);
  redirect(STDERR_FILENO, err, O_WRONLY | O_CREAT | O_TRUNC);
  if (limits.file_size > 0) std::signal(SIGXFSZ, SIG_IGN);
  limit(RLIMIT_FSIZE, limits.file_size);
  limit(RLIMIT_AS, limits.address_space);
  const rlimit none{0, 0};
  setrlimit(RLIMIT_CORE, &none);
  execvp(argv[0], argv.data());
  _exit(127);
}

ChildProgram::~ChildProgram() {
  if (pid_ <= 0) return;
  kill(-pid_, SIGKILL);
  kill(pid_, SIGKILL);  // the process group may not exist yet
  waitpid(pid_, nullptr, 0);
}

bool ChildProgram::runs() const {
  siginfo_t info{};
  if (pid_ <= 0 || waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT) != 0)
    return false;
  return info.si_pid == 0;
}

void ChildProgram::send(int signal) const {
  if (pid_ > 0) kill(pid_, signal);
}

ChildEnd ChildProgram::end(double seconds) {
  ChildEnd out;
  if (pid_ <= 0) return out;
  const Clock::time_point begin = Clock::now();
  int status = 0;
  while (waitpid(pid_, &status, WNOHANG) == 0) {
    if (seconds_since(begin) > seconds && !out.timed_out) {
      out.timed_out = true;
      kill(-pid_, SIGKILL);
    }
    pause_briefly();
  }
  pid_ = -1;
  if (WIFEXITED(status)) out.code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) out.signal = WTERMSIG(status);
  if (folder_.empty()) return out;
  out.err = text_of(folder_ + "/stderr");
  out.out = text_of(folder_ + "/stdout");
  return out;
}

ChildEnd run_shell(const std::string& command, const std::string& folder, double seconds) {
  return ChildProgram({"sh", "-c", command}, folder).end(seconds);
}

bool eventually(const ChildProgram& child, const std::function<bool()>& condition) {
  constexpr double kSeconds = 90;
  for (const Clock::time_point begin = Clock::now(); seconds_since(begin) < kSeconds;) {
    if (condition()) return true;
    if (!child.runs()) return condition();
    pause_briefly();
  }
  child.send(SIGKILL);
  return false;
}

}  // namespace flexmorph::testing
