#pragma once

#include <sys/types.h>

#include <functional>
#include <string>
#include <vector>

#include "geometry/sanitizers.h"

/// Child processes of tests, each with a limit of wall-clock time.
namespace flexmorph::testing {

/// Limits of a process; 0 means that only the limit of the system applies.
struct ChildLimits {
  double address_space = 0;  ///< Limit of the address space, as ulimit -v [bytes].
  /// Limit of a written file, as ulimit -f [bytes]; SIGXFSZ is ignored, so that writing fails.
  double file_size = 0;
};

/// The exit of a process and its output.
struct ChildEnd {
  int code = -1;           ///< Exit code; -1: a signal ended the process.
  int signal = 0;          ///< Signal that ended the process; 0: none.
  bool timed_out = false;  ///< True if the process was killed because it exceeded its time limit.
  /// Text that the process wrote to standard output and to standard error.
  std::string out, err;
};

/// A program that a test starts. Its standard input is /dev/null. It runs in its own process group,
/// which the destructor kills; the kernel kills the program, too, if the test program ends.
class ChildProgram {
 public:
  /// Starts the program.
  /// @param words   program and arguments; the program is found by the search path
  /// @param folder  folder of the files stdout and stderr; empty: the output is discarded
  ChildProgram(const std::vector<std::string>& words, const std::string& folder,
               const ChildLimits& limits = {});
  ~ChildProgram();
  ChildProgram(const ChildProgram&) = delete;
  ChildProgram& operator=(const ChildProgram&) = delete;

  /// Returns the number of the process; -1 after end().
  pid_t pid() const { return pid_; }
  /// Returns true while the process has not ended.
  bool runs() const;
  /// Sends a signal to the process, not to its group.
  void send(int signal) const;
  /// Waits for the end of the process and kills its process group if a time limit [s] is exceeded.
  ChildEnd end(double seconds = kSeconds);

  /// Default time limit [s]; a test of the suite "gate" may take at most 180 s,
  /// and ten times as long with a sanitizer.
  static constexpr double kSeconds = kSanitized ? 1500 : 150;

 private:
  std::string folder_;
  pid_t pid_ = -1;
};

/// Runs a command by the shell.
/// @param folder  folder of the files stdout and stderr; empty: the output is discarded
ChildEnd run_shell(const std::string& command, const std::string& folder = "",
                   double seconds = ChildProgram::kSeconds);

/// Waits until a condition holds, at most 90 s, and at most until the process ends.
/// @returns true if the condition holds; otherwise the process is killed
bool eventually(const ChildProgram& child, const std::function<bool()>& condition);

}  // namespace flexmorph::testing
