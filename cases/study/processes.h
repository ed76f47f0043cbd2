#pragma once

#include <functional>
#include <string>
#include <vector>

/// Processes that may hang, crash or ask for all memory: this program with limits around it. The
/// one runner of studies and of stability.
namespace flexmorph::cases {

struct ChildLimits {
  /// CPU time; then it is asked to end (SIGINT). Ten times that on the clock likewise. 0: no limit.
  double seconds = 0;
  /// CPU time to do so, or ten times that on the clock (that on the clock after an interruption);
  /// then it is killed.
  double grace = 10;
  double memory = 0;  ///< address space [bytes]; 0: no limit
};

/// How a process ended.
struct Ending {
  int code = -1;             ///< exit code; -1 when a signal ended it
  int signal = 0;            ///< that ended it
  bool over_time = false;    ///< it was asked to end by its limits
  double seconds = 0;        ///< CPU time
  bool interrupted = false;  ///< it was told of an interruption
};

struct Child {
  std::vector<std::string> words;          ///< its arguments
  std::string log;                         ///< file for its output
  std::string program = "/proc/self/exe";  ///< this one
};

/// What is told of children, by their places in the list.
struct ChildObserver {
  std::function<void(size_t)> started = {};
  std::function<void(size_t, const Ending&)> ended;
};

/// Runs children, `jobs` at a time, in the order given. SIGINT and SIGTERM are passed on once; no
/// other child is started then.
/// @return false when interrupted
/// @throws Error (input) for a log that cannot be written; Error (numerical) when no process can be
///         started.
bool run_children(const std::vector<Child>& children, int jobs, const ChildLimits& limits,
                  const ChildObserver& observer);

}  // namespace flexmorph::cases
