#pragma once

#include <functional>
#include <string>
#include <vector>

/// Processes that may hang, crash or ask for all memory: this program with limits around it.
namespace flexmorph::cases {

struct ChildLimits {
  double seconds =
      60;             ///< CPU time; then it is asked to end. Ten times that on the clock likewise.
  double grace = 10;  ///< seconds on the clock to do so; then it is ended
  double memory = 4e9;  ///< address space [bytes]
};

/// How a process ended.
struct Ending {
  int code = -1;           ///< exit code; -1 when a signal ended it
  int signal = 0;          ///< that ended it
  bool over_time = false;  ///< it was asked to end
  double seconds = 0;      ///< CPU time
};

struct Child {
  std::vector<std::string> words;          ///< its arguments
  std::string log;                         ///< file for its output
  std::string program = "/proc/self/exe";  ///< this one
};

/// Runs children, `jobs` at a time, in the order given. SIGINT and SIGTERM are passed on once; no
/// other child is started then.
/// @param ended  called as each ends, with its place in the list
/// @return false when interrupted
/// @throws Error (input) for a log that cannot be written; Error (numerical) when no process can be
///         started.
bool run_children(const std::vector<Child>& children, int jobs, const ChildLimits& limits,
                  const std::function<void(size_t, const Ending&)>& ended);

}  // namespace flexmorph::cases
