#include "cases/python/computation.h"

#include <omp.h>

#include <cfenv>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>

#include "cases/process/blas_buffers.h"
#include "geometry/plain_numbers.h"

extern "C" int openblas_get_num_threads();
extern "C" void openblas_set_num_threads(int n);

namespace flexmorph::python {
namespace {

constexpr std::chrono::milliseconds kSignals(50);  // time between two looks at signals

/// Settings of the process that hold while computations of Flexmorph run: OpenBLAS uses one thread,
/// and numbers have a decimal point. The last computation restores what the first one has found.
class ProcessSettings {
 public:
  ProcessSettings() {
    const std::lock_guard lock(kept().mutex);
    if (kept().users++ > 0) return;
    kept().threads = openblas_get_num_threads();
    if (kept().threads != 1) openblas_set_num_threads(1);
    kept().numbers.emplace();
  }
  ~ProcessSettings() {
    const std::lock_guard lock(kept().mutex);
    if (--kept().users > 0) return;
    kept().numbers.reset();
    if (kept().threads != 1) openblas_set_num_threads(kept().threads);
  }
  ProcessSettings(const ProcessSettings&) = delete;

 private:
  struct Kept {
    std::mutex mutex;
    int users = 0, threads = 1;
    std::optional<PlainNumbers> numbers;
  };
  static Kept& kept() {
    static Kept kept;
    return kept;
  }
};

/// The end of the work of a thread.
struct End {
  std::mutex lock;
  std::condition_variable signal;
  bool reached = false;
  std::exception_ptr error;
};

void run(const std::function<void()>& work, int threads, End& end) {
  std::exception_ptr error;
  try {
    std::fesetenv(FE_DFL_ENV);
    omp_set_num_threads(threads);  // for this thread only
    reserve_blas(threads);
    work();
  } catch (...) {
    error = std::current_exception();
  }
  const std::lock_guard guard(end.lock);
  end.error = std::move(error);
  end.reached = true;
  end.signal.notify_all();
}

/// Returns the exception that a signal handler of Python raises; null if there is none.
std::exception_ptr exception_of_signals() {
  const py::gil_scoped_acquire acquire;
  if (PyErr_CheckSignals() == 0) return nullptr;
  try {
    throw py::error_already_set();
  } catch (...) {
    return std::current_exception();
  }
}

}  // namespace

Callback::Callback(const py::object& function) {
  if (function.is_none()) return;
  function_ = std::shared_ptr<py::object>(new py::object(function), [](const py::object* held) {
    const py::gil_scoped_acquire acquire;
    delete held;
  });
}

void compute_in_thread(const std::function<void()>& work, int threads, const StopFlag& flag) {
  std::exception_ptr interruption;
  End end;
  {
    const py::gil_scoped_release release;
    const ProcessSettings settings;
    std::thread worker([&] { run(work, threads, end); });
    std::unique_lock waiting(end.lock);
    while (!end.signal.wait_for(waiting, kSignals, [&] { return end.reached; })) {
      waiting.unlock();
      if (!interruption) {
        interruption = exception_of_signals();
        if (interruption) flag.stop();
      }
      waiting.lock();
    }
    waiting.unlock();
    worker.join();
  }
  if (interruption) std::rethrow_exception(interruption);
  if (end.error) std::rethrow_exception(end.error);
}

}  // namespace flexmorph::python
