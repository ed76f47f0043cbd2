#pragma once

#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <sstream>
#include <string>
#include <vector>

#include "tests/io/scratch.h"

/// The program as tests start it. FLEXMORPH_PROGRAM is its path, FLEXMORPH_SHORT_CASE a case of
/// about a second.
namespace flexmorph::test {

using Words = std::vector<std::string>;

inline Words lines_of(const std::string& text) {
  Words out;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) out.push_back(line);
  return out;
}

/// Starts a command, its output in files of the scratch folder.
inline pid_t start_command(const Scratch& scratch, const Words& words) {
  const std::string out = scratch / "stdout", err = scratch / "stderr";
  std::vector<char*> argv;
  for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    if (!std::freopen(out.c_str(), "w", stdout) || !std::freopen(err.c_str(), "w", stderr))
      _exit(126);
    execvp(argv[0], argv.data());
    _exit(127);
  }
  return child;
}

/// Starts the program with these arguments, its output in files of the scratch folder.
inline pid_t start(const Scratch& scratch, const Words& arguments) {
  Words words = {FLEXMORPH_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  return start_command(scratch, words);
}

/// Exit code of a run that is whole, but ended after so few iterations that its design is worse
/// than uniform material: "done, not usable".
inline constexpr int kTooFew = 5;

/// Waits until a condition holds.
/// @return false if the child ended before, or the time [s] was over; the child is killed then
template <class Condition>
bool eventually(double seconds, pid_t child, const Condition& condition) {
  for (double waited = 0; waited < seconds; waited += 0.01) {
    if (condition()) return true;
    siginfo_t ended{};
    if (waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOHANG | WNOWAIT) != 0 ||
        ended.si_pid == child)
      return condition();
    usleep(10'000);
  }
  kill(child, SIGKILL);
  return false;
}

struct Ended {
  int code = -1;  ///< exit code, -1 when a signal ended it
  std::string out, err;
};

inline Ended end_of(const Scratch& scratch, pid_t child) {
  int status = 0;
  waitpid(child, &status, 0);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, contents_of(scratch / "stdout"),
          contents_of(scratch / "stderr")};
}

inline Ended flexmorph(const Scratch& scratch, const Words& arguments) {
  return end_of(scratch, start(scratch, arguments));
}

/// Runs a case with changes; what it expects of itself as it is does not count with them.
inline Ended run(const Scratch& scratch, const std::string& name, const std::string& folder,
                 Words changes = {}) {
  Words words = {"run", name, "-o", folder};
  if (!changes.empty()) changes.emplace_back("expect=");
  for (const std::string& change : changes) words.insert(words.end(), {"--set", change});
  return flexmorph(scratch, words);
}

/// Runs short_plate.toml with changes.
inline Words short_run(const std::string& folder, const Words& changes = {}) {
  Words words = {"run", FLEXMORPH_SHORT_CASE, "-o", folder};
  for (const std::string& change : changes) {
    words.emplace_back("--set");
    words.push_back(change);
  }
  return words;
}

}  // namespace flexmorph::test
