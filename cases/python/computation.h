#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <functional>
#include <memory>

/// Calls of Flexmorph from Python without the global interpreter lock.
namespace flexmorph::python {

namespace py = pybind11;

/// A flag that stops computations. Copies share the flag; they may be used by any thread.
class StopFlag {
 public:
  /// Requests that the computation ends after its current step or iteration.
  void stop() const { *stopped_ = true; }
  /// Withdraws the request, for the next computation.
  void reset() const { *stopped_ = false; }
  /// Returns true until stop() is called.
  bool keeps_running() const { return !*stopped_; }

 private:
  std::shared_ptr<std::atomic<bool>> stopped_ = std::make_shared<std::atomic<bool>>(false);
};

/// Runs `work` in a thread of its own while this thread, without the global interpreter lock, waits
/// and handles signals of Python. If a signal handler raises an exception, as that of Ctrl-C does,
/// the flag is set, and the exception is thrown when `work` has returned.
///
/// The thread computes with the default floating-point settings and with numbers in the C locale;
/// OpenBLAS uses one thread as in the program, and its setting is restored afterwards. Therefore a
/// computation gives equal bits, whatever other packages have set.
/// @param threads  number of threads for loads and cells
/// @throws the exception of `work`, also if it is an exception of Python
void compute_in_thread(const std::function<void()>& work, int threads, const StopFlag& flag);

/// Returns a cancellation callback that reads a flag.
inline std::function<bool()> callback_of(const StopFlag& flag) {
  return [flag] { return flag.keeps_running(); };
}

/// A function of Python that any thread may copy, and call while it holds the global interpreter
/// lock.
class Callback {
 public:
  Callback() = default;
  /// Holds a function; None stands for no function.
  explicit Callback(const py::object& function);
  /// Returns true if there is a function.
  explicit operator bool() const { return function_ != nullptr; }
  /// Returns the function. The caller holds the global interpreter lock.
  const py::object& get() const { return *function_; }

 private:
  std::shared_ptr<py::object> function_;
};

}  // namespace flexmorph::python
