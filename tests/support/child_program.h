#pragma once

#include <sys/types.h>

#include <functional>
#include <string>
#include <vector>

/// Child processes of tests, each with a limit of wall-clock time.
namespace flexmorph::testing {

/// What a process may take; 0: as much as the system gives.
struct ChildLimits {
  double address_space = 0;  ///< ulimit -v [bytes]
  double file_size = 0;      ///< ulimit -f [bytes]; SIGXFSZ is ignored, so that writing fails
};

/// How a process ended.
struct ChildEnd {
  int code = -1;           ///< exit code; -1: a signal ended the process
  int signal = 0;          ///< the signal that ended the process; 0: none
  bool timed_out = false;  ///< true: the process was killed because its time was over
  std::string out, err;    ///< what it wrote to standard output and standard error
};

/// A program that a test starts. Its standard input is /dev/null. It has a process group of its
/// own, which the destructor kills; it is killed, too, when the test program dies.
class ChildProgram {
 public:
  /// @param words   of the command, the program first; the search path is used
  /// @param folder  of the files stdout and stderr; empty: output is thrown away
  ChildProgram(const std::vector<std::string>& words, const std::string& folder,
               const ChildLimits& limits = {});
  ~ChildProgram();
  ChildProgram(const ChildProgram&) = delete;
  ChildProgram& operator=(const ChildProgram&) = delete;

  /// Returns the number of the process; -1 after end().
  pid_t pid() const { return pid_; }
  /// Tells whether the process has not ended.
  bool runs() const;
  /// Sends a signal to the process alone.
  void send(int signal) const;
  /// Waits for the end of the process, and kills its group after a time [s].
  ChildEnd end(double seconds = kSeconds);

  /// Time limit where a test asks for none [s]; tests of the gate have at most 180 s.
  static constexpr double kSeconds = 150;

 private:
  std::string folder_;
  pid_t pid_ = -1;
};

/// Runs a command of a shell.
/// @param folder  of the files stdout and stderr; empty: output is thrown away
ChildEnd run_shell(const std::string& command, const std::string& folder = "",
                   double seconds = ChildProgram::kSeconds);

/// Waits until a condition holds: at most 90 s, and at most until the process ends.
/// @return whether it holds; if it does not, the process is killed
bool eventually(const ChildProgram& child, const std::function<bool()>& condition);

}  // namespace flexmorph::testing
