#pragma once

#include <functional>
#include <string>
#include <vector>

/// Child processes that run this program with limits of time and memory, because a run may hang,
/// crash or allocate too much memory. All studies use these functions.
namespace flexmorph::cases {

/// Limits of time and memory of a child process.
struct ChildLimits {
  /// CPU time after which a process receives SIGINT [s]; it also receives SIGINT after ten times
  /// this value of wall time. 0 means no limit.
  double seconds = 0;

  /// CPU time that a process may use after SIGINT before it is killed [s]. It is also killed after
  /// ten times this value of wall time, or after this value of wall time if the study was
  /// interrupted.
  double grace = 10;

  double memory = 0;  ///< Limit of the address space [bytes]; 0 means no limit.
};

/// The end of a process: its exit code or signal, and the reason.
struct Ending {
  int code = -1;             ///< Exit code; -1 if a signal ended the process.
  int signal = 0;            ///< Signal that ended the process; 0 if none did.
  bool over_time = false;    ///< True if the process received SIGINT because of its time limit.
  double seconds = 0;        ///< CPU time of the process [s].
  bool interrupted = false;  ///< True if the process received SIGINT because of an interruption.
};

/// A child process: its program, its arguments and its log.
struct Child {
  std::vector<std::string> words;          ///< Arguments, without the name of the program.
  std::string log;                         ///< Path of the file for its output.
  std::string program = "/proc/self/exe";  ///< Path of the program; by default this program.
};

/// Callbacks that report the start and the end of children, by their indices in the list.
struct ChildObserver {
  std::function<void(size_t)> started = {};          ///< Callback at the start; may be empty.
  std::function<void(size_t, const Ending&)> ended;  ///< Callback at the end.
  /// Callback with the children that run, called again and again; may be empty.
  std::function<void(const std::vector<size_t>&)> waiting = {};
};

/// Runs children in the given order, up to `jobs` at the same time. After SIGINT or SIGTERM, every
/// running child receives SIGINT once, and no other child is started.
/// @return false if the program was interrupted
/// @throws Error (input) for a log that cannot be written; Error (numerical) when no process can be
///         started.
bool run_children(const std::vector<Child>& children, int jobs, const ChildLimits& limits,
                  const ChildObserver& observer);

}  // namespace flexmorph::cases
