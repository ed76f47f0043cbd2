#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

namespace flexmorph::io {

/// Does tasks in the order in which they come: at once, or in a thread of its own while the caller
/// goes on. For files, which nobody waits for.
class Background {
 public:
  /// @param own_thread  false: all is done at once, as where the system has no thread to give
  explicit Background(bool own_thread);
  /// When all is done. Errors that nobody asked for are lost.
  ~Background();
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;

  /// The task must own what it uses. Waits where kMost tasks wait already. After a task that threw
  /// none is done any more. @throws what the first one threw.
  void then(std::function<void()> task);
  /// Until all is done. @throws what the first task threw that did.
  void wait();

  static constexpr size_t kMost = 16;

 private:
  void work();
  void rethrow();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> tasks_;  // the first one is being done
  std::exception_ptr failure_;
  bool ends_ = false;
  std::thread thread_;  // last: it uses the others
};

}  // namespace flexmorph::io
