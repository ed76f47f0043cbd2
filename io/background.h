#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

namespace flexmorph::io {

/// A queue that executes tasks in their order, either immediately or in a separate thread while the
/// caller continues. It is meant for writing files, for which no computation has to wait.
class Background {
 public:
  /// Starts the thread.
  /// @param own_thread  false: tasks are executed immediately in the thread of the caller, as they
  ///         also are when the system cannot create a thread
  explicit Background(bool own_thread);
  /// Waits until all tasks are done. Errors that were not reported before are lost.
  ~Background();
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;

  /// Adds a task. The task must own the data that it uses. The call waits while kMaxWaitingJobs
  /// tasks are in the queue.
  /// @throws the exception of a task that threw since the last call; the tasks after it, and the
  /// new
  ///         task, are dropped. An exception is thrown once; later tasks are executed again, so
  ///         that the files of a failed run can be written.
  void then(std::function<void()> task);
  /// Waits until all tasks are done.
  /// @throws the exception of a task that threw since the last call, see then()
  void wait();

  static constexpr size_t kMaxWaitingJobs = 16;  ///< Largest number of tasks in the queue.

 private:
  void work();
  void rethrow();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> tasks_;  // the first one is being executed
  std::exception_ptr failure_;
  bool ends_ = false;
  std::thread thread_;  // last member, because the thread uses the others
};

}  // namespace flexmorph::io
